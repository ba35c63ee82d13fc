#!/bin/sh
# failover.sh [-k "PROFILE..."] [-s "STANDBYS..."] [LOSS...]    e.g. failover.sh -k lan-server -s "0 2" 0 0.5
# How long a robot waits for the first answer of the localizer that it has chosen: at its start, and
# after its localizer was killed; by the loss of datagrams each way, and by the number of localizers
# that it is connected to beforehand. Two localizers, ROBOTS (default 8) robots, which send a submap
# of one keyframe twice a second. Needs root, and fast-discovery-server for the profiles -server.
# BEFORE and AFTER are the seconds before and after the kill.
set -eu

. "$(dirname "$0")/one_address.sh"
robots=${ROBOTS:-8}
before=${BEFORE:-30}
after=${AFTER:-60}

profiles=lan-server
standbys="0 2"
while getopts k:s: option; do
  case $option in
    k) profiles=$OPTARG ;;
    s) standbys=$OPTARG ;;
    *) exit 2 ;;
  esac
done
shift $((OPTIND - 1))
[ $# -gt 0 ] || set -- 0 0.5 0.7 0.9

measure() {
  qos=$1
  loss=$2
  count=$3
  children=""
  printf 'client: {connections: {standbys: %s}}\n' "$count" >"$scratch/config"
  start_server "$qos"
  start_cloud "$qos" localizer_2
  start_cloud "$qos" localizer_1
  i=0
  while [ $i -lt "$robots" ]; do
    i=$((i + 1))
    direction="{loss: $loss, delay_s: 0.05, rate_bytes_per_s: 0, queue_bytes: 1500}"
    printf 'seed: %s\nuplink: %s\ndownlink: %s\n' "$i" "$direction" "$direction" >"$scratch/link_$i"
    "$bin/fleet_robot" --robot-id "robot_$i" --qos "$root/qos_profiles/$qos.xml" --submaps 2 \
      --link "$scratch/link_$i" --config "$scratch/config" \
      --settled 9999 >"$scratch/robot_$i" 2>&1 &
    children="$children $!"
  done
  sleep "$before"
  kill -KILL $cloud
  sleep "$after"
  # shellcheck disable=SC2086  # words on purpose
  kill $children 2>/dev/null || true
  wait
  cat "$scratch"/robot_* >"$scratch/all"
  rm -f "$scratch"/robot_*
  for what in start failover; do report "$qos" "$loss" "$count" $what; done
}

# The answers of the first localizer that each robot chose, or of that chosen after the kill.
report() {
  awk -v what="$4" -v killed="$before" '$1 == "chosen" {
      first = !($2 in seen); seen[$2] = 1
      if (what == "start" ? first : !first && $4 >= killed && $3 == "localizer_2") print $5 }' \
    "$scratch/all" | sort -n >"$scratch/waits"
  awk -v words="$*" '{ waits[++n] = $1 } END {
      split(words, w, " ")
      printf "%-12s %5s %8s %-9s %4d %8s %8s\n", w[1], w[2], w[3], w[4], n,
        n ? waits[int((n + 1) / 2)] : "-", n ? waits[n] : "-" }' "$scratch/waits"
}

printf "%-12s %5s %8s %-9s %4s %8s %8s\n" profile loss standbys after n "median s" "most s"
for qos in $profiles; do
  for loss in "$@"; do
    for count in $standbys; do measure "$qos" "$loss" "$count"; done
  done
done
