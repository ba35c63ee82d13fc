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

run_tests() {
  run sh deploy/build.sh "$1" || fail "the build of $1"
  echo "test/run.sh: testing $1"
  outcome=0
  run ctest --preset "$1" --parallel "$(nproc)" --output-junit "$scratch/results.xml" \
    --test-output-size-passed 65536 || outcome=$?
  summarize "$1" || outcome=1
  [ $outcome -eq 0 ] || fail "tests of $1"
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
  run sh deploy/build.sh debug fleetloc_idl || fail "the types of idl/, which clang-tidy needs"
  echo "test/run.sh: clang-tidy on $(wc -l <"$scratch/units") files"
  run xargs -a "$scratch/units" -r -n 1 -P "$(nproc)" clang-tidy -p build/debug --quiet ||
    fail "clang-tidy"
  echo "test/run.sh: clang-format and clang-tidy have nothing to say"
}

if [ "$mode" = tidy ]; then
  sh deploy/install-deps.sh clang-format clang-tidy || exit $?
  tidy "${2:-}"
else
  # A packet filter, a tunnel, another kind of computer, and DDS of another vendor.
  sh deploy/install-deps.sh nftables wireguard-tools wireguard-go g++-aarch64-linux-gnu \
    qemu-user-static cyclonedds-dev cyclonedds-tools || exit $?
  run_tests "$mode"
fi
