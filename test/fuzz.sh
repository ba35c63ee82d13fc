#!/bin/sh
# test/fuzz.sh [SECONDS [TARGET...]]
# Fuzzes the targets of test/fuzz, each for that long (60 s), all or those named: 'net_*' are the
# decoders of what comes from the network, 'file_*' those of files. Ends with 1 if one has a finding.
set -eu

cd "$(dirname "$0")/.."

fail() {
  echo "test/fuzz.sh: FAILED: $1" >&2
  exit 1
}

usage() {
  echo "usage: test/fuzz.sh [SECONDS [TARGET...]]" >&2
  exit 2
}

seconds=${1:-60}
case $seconds in
  *[!0-9]* | 0*) usage ;;
esac
[ $# -eq 0 ] || shift

# Those that a pattern means.
targets_like() {
  for source in test/fuzz/net_*.cpp test/fuzz/file_*.cpp; do
    name=$(basename "$source" .cpp)
    # shellcheck disable=SC2254  # a pattern on purpose
    case $name in
      $1) echo "$name" ;;
    esac
  done
}

[ $# -gt 0 ] || set -- '*'
targets=""
for pattern in "$@"; do
  some=$(targets_like "$pattern")
  [ -n "$some" ] || fail "no target '$pattern'; there are:$(targets_like '*' | sed 's/^/ /' | tr -d '\n')"
  targets="$targets $some"
done
# shellcheck disable=SC2086  # words on purpose
set -- $targets

# Targets write their input to a file, which is quickest in memory.
scratch=$(mktemp -d -p /dev/shm 2>/dev/null || mktemp -d)
export TMPDIR="$scratch"
# shellcheck source=test/children.sh
. test/children.sh

# What libFuzzer says of itself.
statistic() {
  sed -n "s/^stat::$1: *//p" "$scratch/log" | tail -n 1
}

# What is new in a corpus stays in build/fuzz, and so does a finding, until somebody mends its cause
# and puts it into test/fuzz/findings.
fuzz() {
  corpus=build/fuzz/corpus/$1
  found=build/fuzz/findings/$1
  mkdir -p "$corpus" "$found"
  known=test/fuzz/findings/$1
  [ -d "$known" ] || known=""
  outcome=0
  # shellcheck disable=SC2086
  run "build/fuzz/bin/fuzz_$1" -max_total_time="$seconds" -timeout=20 -rss_limit_mb=2048 \
    -malloc_limit_mb=512 -print_final_stats=1 -artifact_prefix="$found/" \
    "$corpus" "build/fuzz/seeds/$1" $known >"$scratch/log" 2>&1 || outcome=$?
  covered=$(sed -n 's/.* cov: \([0-9]*\) .*/\1/p' "$scratch/log" | tail -n 1)
  finding=$(sed -n 's/.*Test unit written to //p' "$scratch/log" | tail -n 1)
  echo "$1: $seconds s, $(statistic number_of_executed_units) executions," \
    "$(statistic average_exec_per_sec)/s, coverage ${covered:-0}, findings: ${finding:-none}"
  [ $outcome -ne 0 ] || return 0
  cp "$scratch/log" "$found/log"
  sed -n '/ERROR: \|runtime error: \|does not hold: \|SUMMARY: /p' "$scratch/log" | head -n 3 >&2
  echo "test/fuzz.sh: $1: see $found/log" >&2
  return 1
}

# The compiler's run-time libraries, and what makes names of addresses.
sh deploy/install-deps.sh clang libclang-rt-dev llvm || exit $?
programs=$(printf 'fuzz_%s ' "$@")
# shellcheck disable=SC2086
run sh deploy/build.sh fuzz fuzz_seeds $programs || fail "the build"
rm -rf build/fuzz/seeds
run build/fuzz/bin/fuzz_seeds build/fuzz/seeds || fail "the seeds"

export ASAN_OPTIONS=new_delete_type_mismatch=0
export UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1
findings=0
for target in "$@"; do
  fuzz "$target" || findings=$((findings + 1))
done
[ $findings -eq 0 ] || fail "findings in $findings of $# targets"
