#!/bin/sh
# fleetloc-container robot|cloud|drivers [OPTION...]   what the images start
# Runs fleetloc-robot, fleetloc-cloud or fleetloc-play as the environment says, with further options
# behind. The keys of robots and localizers are in /keys, see deploy/packages/start.sh. What they say
# goes to the container's log and to /runs/NAME.log, what they write to /runs/NAME; what earlier starts
# have written is kept there as NAME.1, NAME.2 and so on.
#
# fleetloc-container is-written FILE                    their health check
# Whether FILE of that folder has been written to within the last 5 s.
set -eu

folder=/tmp/run  # a link to the folder, for the health check

fail() {
  echo "fleetloc-container: $1" >&2
  exit 2
}

# The file for --sensors. Where drivers are on a network: a copy for it, with one domain of ROS 2 for
# the robot and the drivers of each number, of which the drivers look for the robot.
sensors() {  # robot|drivers NAME
  [ -n "${FLEETLOC_SENSORS_NETWORK:-}" ] || { echo "$FLEETLOC_SENSORS"; return; }
  domain=${2##*[!0-9]}
  [ -n "$domain" ] || fail "'$2' does not end with a number, which says the domain of its sensors"
  # CONTAINER.NETWORK stands behind each of this container's addresses.
  address=$(for address in $(hostname -i); do getent -s dns hosts "$address" | head -n 1; done |
    awk -v network="$FLEETLOC_SENSORS_NETWORK" '$2 ~ network "$" {print $1; exit}')
  [ -n "$address" ] || fail "FLEETLOC_SENSORS_NETWORK: not in a network $FLEETLOC_SENSORS_NETWORK"
  other=$address
  if [ "$1" = drivers ]; then
    other=$(getent ahostsv4 "$2" | awk '{print $1; exit}')
    [ -n "$other" ] || fail "FLEETLOC_ROBOT: no host $2"
  fi
  profiles=$(echo /usr/share/fleetloc/*/qos_profiles)  # one in each image
  cp "$profiles/ros2.xml" /tmp
  sed "s/192\.168\.2\.1/$address/; s/192\.168\.2\.2/$other/" "$profiles/ros2-network.xml" \
    >/tmp/ros2-network.xml
  sed "s|DATASET|$FLEETLOC_DATASET|; s/^domain: .*/domain: $domain\nqos: ros2-network.xml/" \
    "$FLEETLOC_SENSORS" >/tmp/sensors.yaml
  echo /tmp/sensors.yaml
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
    name=$FLEETLOC_ROBOT_ID
    set -- --robot-id "$name" --domain "$FLEETLOC_DOMAIN" \
      ${FLEETLOC_LINK:+--link "$FLEETLOC_LINK"} "$@"
    # Beside a dataset, the pose to start from.
    start=$FLEETLOC_DATASET.start
    if [ -n "${FLEETLOC_SENSORS:-}" ]; then
      sensors=$(sensors robot "$name")
      set -- --sensors "$sensors" --last-pose "/runs/$name.last_pose.yaml" "$@"
      [ ! -e "/runs/$name.last_pose.yaml" ] || start=
    else
      set -- --dataset "$FLEETLOC_DATASET" "$@"
    fi
    if [ -f "$start" ]; then
      set -- --initial-pose "$(cat "$start")" "$@"
    fi
    ;;
  cloud)
    name=$FLEETLOC_NAME
    set -- --map "$FLEETLOC_MAP" --name "$name" --domain "$FLEETLOC_DOMAIN" "$@"
    ;;
  drivers)
    sensors=$(sensors drivers "$FLEETLOC_ROBOT")
    exec fleetloc-play "$FLEETLOC_DATASET" --sensors "$sensors" "$@"
    ;;
  is-written)
    [ -n "$(find "$folder/$1" -size +0 -newermt '5 seconds ago' 2>/dev/null)" ] && exit 0
    echo "$folder/$1: nothing new for 5 s" >&2
    exit 1
    ;;
  *) fail "usage: fleetloc-container robot|cloud|drivers [OPTION...], or is-written FILE" ;;
esac
keep_earlier "$name"
ln -sfn "/runs/$name" "$folder"
run "/runs/$name.log" "/usr/share/fleetloc/$part/start" "$part" /keys --out "/runs/$name" "$@"
