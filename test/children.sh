# . test/children.sh   for scripts of test/ that start long commands: however the script ends, so does
# what run has started, and the folder $scratch goes.

child=""
end_child() {
  trap - EXIT INT TERM HUP
  if [ -n "$child" ]; then
    kill -TERM "-$child" 2>/dev/null || true
    wait "$child" 2>/dev/null || true
  fi
  rm -rf "${scratch:?}"
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
