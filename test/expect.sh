# . test/expect.sh   for scripts of test/ that check many things: each expectation that fails names
# itself, and is counted.

failures=0
expect() {  # WHAT COMMAND WORD...
  what=$1
  shift
  "$@" || {
    echo "FAILED: $what" >&2
    failures=$((failures + 1))
  }
}
not() { ! "$@"; }
