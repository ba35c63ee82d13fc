#!/bin/sh
# fleetloc-container robot|cloud [OPTION...]   what the images start
# Runs fleetloc-robot or fleetloc-cloud as the environment says, with further options behind. What
# the program says goes to the container's log and to /runs/NAME.log, what it writes to /runs/NAME;
# what earlier starts have written is kept there as NAME.1, NAME.2 and so on.
#
# fleetloc-container is-written FILE           their health check
# Whether FILE of that folder has been written to within the last 5 s.
set -eu

folder=/tmp/run  # a link to the folder, for the health check

fail() {
  echo "fleetloc-container: $1" >&2
  exit 2
}

# Puts the number that compose gives each container of a service in place of %n in an id.
numbered() {
  case $1 in
    *%n*)
      address=$(hostname -i)
      name=$(getent -s dns hosts "${address%% *}" | awk '{print $2; exit}')
      name=${name%%.*}
      number=${name##*[!0-9]}
      [ -n "$number" ] || fail "'$1': this container's name '$name' ends with no number"
      echo "${1%%%n*}$number${1#*%n}"
      ;;
    *) echo "$1" ;;
  esac
}

keep_earlier() {  # NAME
  [ -e "/runs/$1" ] || return 0
  number=1
  while [ -e "/runs/$1.$number" ]; do number=$((number + 1)); done
  mv "/runs/$1" "/runs/$1.$number"
}

# Runs a command to its end, which SIGTERM asks for, with its output in a file as well.
run() {  # LOG COMMAND...
  log=$1
  shift
  rm -f /tmp/output
  mkfifo /tmp/output
  tee -a "$log" </tmp/output &
  tee=$!
  "$@" >/tmp/output 2>&1 &
  child=$!
  trap 'kill -TERM "$child" 2>/dev/null' TERM INT
  status=0
  wait "$child" || status=$?
  while kill -0 "$child" 2>/dev/null; do  # it was the signal that has ended the wait
    status=0
    wait "$child" || status=$?
  done
  wait "$tee" || true
  exit "$status"
}

part=${1:-}
[ $# -eq 0 ] || shift
case $part in
  robot)
    name=$(numbered "$FLEETLOC_ROBOT_ID")
    set -- --robot-id "$name" --dataset "$FLEETLOC_DATASET" --qos "$FLEETLOC_QOS" \
      --domain "$FLEETLOC_DOMAIN" ${FLEETLOC_LINK:+--link "$FLEETLOC_LINK"} "$@"
    # Beside a dataset, the pose to start from.
    if [ -f "$FLEETLOC_DATASET.start" ]; then
      set -- --initial-pose "$(cat "$FLEETLOC_DATASET.start")" "$@"
    fi
    ;;
  cloud)
    name=$(numbered "$FLEETLOC_NAME")
    set -- --map "$FLEETLOC_MAP" --name "$name" --qos "$FLEETLOC_QOS" --domain "$FLEETLOC_DOMAIN" \
      "$@"
    ;;
  is-written)
    [ -n "$(find "$folder/$1" -size +0 -newermt '5 seconds ago' 2>/dev/null)" ] && exit 0
    echo "$folder/$1: nothing new for 5 s" >&2
    exit 1
    ;;
  *) fail "usage: fleetloc-container robot|cloud [OPTION...], or is-written FILE" ;;
esac
keep_earlier "$name"
ln -sfn "/runs/$name" "$folder"
run "/runs/$name.log" "fleetloc-$part" --out "/runs/$name" "$@"
