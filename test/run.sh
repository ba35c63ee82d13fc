#!/bin/sh
# test/run.sh [release|asan|tsan]   installs packages, builds, runs every test of the preset
# test/run.sh tidy [BASE]           clang-format and clang-tidy on what changed since BASE, or on all
set -eu

cd "$(dirname "$0")/.."
mode=${1:-release}

fail() {
  echo "test/run.sh: FAILED: $1" >&2
  exit 1
}

usage() {
  echo "usage: test/run.sh [release|asan|tsan|tidy [BASE]]" >&2
  exit 2
}

case $mode in
  release | asan | tsan) [ $# -le 1 ] || usage ;;
  tidy) [ $# -le 2 ] || usage ;;
  *) usage ;;
esac

# They would bring in another Fast DDS: a sourced ROS, conda.
unset CMAKE_PREFIX_PATH AMENT_PREFIX_PATH CONDA_PREFIX LD_LIBRARY_PATH || true

# However this script ends, so does what it has started.
scratch=$(mktemp -d)
child=""
end_child() {
  trap - EXIT INT TERM HUP
  rm -rf "$scratch"
  if [ -n "$child" ]; then
    kill -TERM "-$child" 2>/dev/null || true
    wait "$child" 2>/dev/null || true
  fi
}
trap end_child EXIT
trap 'end_child; exit 130' INT
trap 'end_child; exit 143' TERM HUP

# Runs a command in a process group of its own. Signals are handled at once, not after it.
run() {
  setsid "$@" </dev/null &
  child=$!
  status=0
  wait "$child" || status=$?
  child=""
  return $status
}

# Compilers take up to 2 GB each: CMake limits them by memory, see FleetlocTargets.cmake. In a
# container with less memory than its host, that is counted here.
compile_jobs() {
  limit=$(cat /sys/fs/cgroup/memory.max 2>/dev/null || echo max)
  kilobytes=$(awk '/^MemAvailable:/ {print $2}' /proc/meminfo)
  case $limit in
    max | "") ;;
    *) [ $((limit / 1024)) -ge "$kilobytes" ] || kilobytes=$((limit / 1024)) ;;
  esac
  jobs=$((kilobytes / 2000000 + 1))
  cores=$(nproc)
  [ "$jobs" -le "$cores" ] || jobs=$cores
  echo "$jobs"
}

configure() {
  echo "test/run.sh: configuring $1"
  jobs=$(compile_jobs)
  run cmake --preset "$1" -DFLEETLOC_COMPILE_JOBS="$jobs" || fail "cmake --preset $1"
}

run_tests() {
  configure "$1"
  echo "test/run.sh: building $1, $jobs at once"
  run cmake --build "build/$1" --parallel "$jobs" || fail "the build of $1"
  echo "test/run.sh: testing $1"
  run ctest --preset "$1" --parallel "$(nproc)" || fail "tests of $1"
}

# Sources that changed since $1 and still exist, with the sources that include a changed header; or
# all.
changed_sources() {
  if [ -z "$1" ]; then
    find shared robot cloud deploy test -name '*.[ch]pp' | sort
    return
  fi
  { git diff --name-only --diff-filter=d "$1" -- && git ls-files --others --exclude-standard; } |
    { grep -E '^(shared|robot|cloud|deploy|test)/.*\.[ch]pp$' || true; } |
    while read -r file; do
      echo "$file"
      case $file in
        *.hpp)
          grep -rlF --include='*.cpp' "#include \"$file\"" shared robot cloud deploy test || true
          ;;
      esac
    done | sort -u
}

tidy() {
  base=${1:-}
  if [ -n "$base" ]; then
    git rev-parse --quiet --verify "$base^{commit}" >/dev/null || fail "no commit '$base'"
  fi
  changed_sources "$base" >"$scratch/sources"
  if [ ! -s "$scratch/sources" ]; then
    echo "test/run.sh: no source has changed since $base"
    return
  fi
  grep '\.cpp$' "$scratch/sources" >"$scratch/units" || true  # they bring their headers
  echo "test/run.sh: clang-format on $(wc -l <"$scratch/sources") files"
  run xargs -a "$scratch/sources" clang-format --dry-run -Werror || fail "clang-format"
  configure release
  run cmake --build build/release --parallel "$jobs" --target fleetloc_idl ||
    fail "the types of idl/, which clang-tidy needs"
  echo "test/run.sh: clang-tidy on $(wc -l <"$scratch/units") files, $jobs at once"
  run xargs -a "$scratch/units" -r -n 1 -P "$jobs" clang-tidy -p build/release --quiet ||
    fail "clang-tidy"
  echo "test/run.sh: clang-format and clang-tidy have nothing to say"
}

if [ "$mode" = tidy ]; then
  sh deploy/install-deps.sh clang-format clang-tidy || exit $?
  tidy "${2:-}"
else
  sh deploy/install-deps.sh || exit $?
  run_tests "$mode"
fi
