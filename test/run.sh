#!/bin/sh
# test/run.sh [release|asan|tsan]   installs packages, builds, runs every test of the preset
# test/run.sh coverage              unit tests with sanitizers, and which lines they reach
# test/run.sh tidy [BASE]           clang-format and clang-tidy on what changed since BASE, or on all
# test/run.sh ci [BASE]             release, coverage, and tidy since BASE (the commit before)
set -eu

cd "$(dirname "$0")/.."
mode=${1:-release}

fail() {
  echo "test/run.sh: FAILED: $1" >&2
  exit 1
}

usage() {
  echo "usage: test/run.sh [release|asan|tsan|coverage|tidy [BASE]|ci [BASE]]" >&2
  exit 2
}

case $mode in
  release | asan | tsan | coverage) [ $# -le 1 ] || usage ;;
  tidy | ci) [ $# -le 2 ] || usage ;;
  *) usage ;;
esac

scratch=$(mktemp -d)
# shellcheck source=test/children.sh
. test/children.sh

# What ran, and what was skipped and why. Fails if all of a group was skipped without an excuse.
summarize() {
  for group in $(ctest --preset "$1" --print-labels | sed -n "s/^  \([^ ]*\)\$/\1/p"); do
    ctest --preset "$1" --show-only --label-regex "^$group\$" |
      sed -n "s/^ *Test *#[0-9]*: /$group /p"
  done >"$scratch/groups"
  awk -v mode="$1" -f test/summary.awk "$scratch/groups" "$scratch/results.xml"
}

# run_tests PRESET [TARGET...]
run_tests() {
  # A packet filter, a tunnel, another kind of computer, and DDS of another vendor.
  sh deploy/install-deps.sh nftables wireguard-tools wireguard-go g++-aarch64-linux-gnu \
    qemu-user-static cyclonedds-dev cyclonedds-tools || exit $?
  run sh deploy/build.sh "$@" || fail "the build of $1"
  echo "test/run.sh: testing $1"
  outcome=0
  run ctest --preset "$1" --parallel "$(nproc)" --output-junit "$scratch/results.xml" \
    --test-output-size-passed 65536 || outcome=$?
  summarize "$1" || outcome=1
  [ $outcome -eq 0 ] || fail "tests of $1"
}

# Which lines of the libraries the unit tests reach: all, and the files with the least.
coverage() {
  sh deploy/install-deps.sh gcovr || exit $?
  if [ -d build/coverage ]; then
    find build/coverage -name '*.gcda' -delete
  fi
  run_tests coverage unit_tests
  echo "test/run.sh: counting lines"
  run gcovr --root . --filter '(shared|robot|cloud|deploy)/' --exclude-throw-branches -j "$(nproc)" \
    --csv "$scratch/coverage.csv" build/coverage || fail "gcovr"
  awk -F, -f test/coverage.awk "$scratch/coverage.csv"
}

# Sources that changed since $1 and still exist, with one that includes each changed header, its own if
# there is one; or all.
changed_sources() {
  if [ -z "$1" ]; then
    find shared robot cloud deploy test -name '*.[ch]pp' | sort
    return
  fi
  { git diff --name-only --diff-filter=d "$1" -- && git ls-files --others --exclude-standard; } |
    { grep -E '^(shared|robot|cloud|deploy|test)/.*\.[ch]pp$' || true; } |
    while read -r file; do
      echo "$file"
      own=${file%.hpp}.cpp
      case $file in
        *.hpp)
          if [ -f "$own" ]; then
            echo "$own"
          else
            { grep -rlF --include='*.cpp' "#include \"$file\"" shared robot cloud deploy test || true; } |
              sort | head -n 1
          fi
          ;;
      esac
    done | sort -u
}

tidy() {
  sh deploy/install-deps.sh clang-format clang-tidy || exit $?
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
  run sh deploy/build.sh debug fleetloc_idl || fail "the types of idl/, which clang-tidy needs"
  echo "test/run.sh: clang-tidy on $(wc -l <"$scratch/units") files"
  run xargs -a "$scratch/units" -r -n 1 -P "$(nproc)" clang-tidy -p build/debug --quiet ||
    fail "clang-tidy"
  echo "test/run.sh: clang-format and clang-tidy have nothing to say"
}

case $mode in
  tidy) tidy "${2:-}" ;;
  coverage) coverage ;;
  ci)
    run_tests release
    coverage
    # A clone of one commit does not know what changed.
    if [ $# -eq 1 ] && ! git rev-parse --quiet --verify HEAD~1 >/dev/null; then
      echo "test/run.sh: tidy: skipped: this clone has no commit before"
    else
      tidy "${2:-HEAD~1}"
    fi
    ;;
  *) run_tests "$mode" ;;
esac
