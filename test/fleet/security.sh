#!/bin/sh
# security.sh [-k "PROFILE..."] [LOSS...]         e.g. security.sh -k "wifi wifi-secure" 0 10 30
# What DDS Security costs: ROBOTS robots (10; test/fleet/fleet_robot.cpp) and a localizer, each side
# in a network of its own, between which nftables drops LOSS % of the packets each way, of a datagram
# in fragments each by itself. Prints, for each profile and loss, when robots had their localizer and
# its first answer, their bytes in the first 12 s and at rest, and with SUBMAPS a second those, too.
# With LIMIT it fails if the last one takes longer [s]. Needs root and nftables.
set -eu

if [ -n "${SKIP:-}" ]; then
  command -v nft >/dev/null && unshare --net --mount true 2>/dev/null || exit "$SKIP"
fi
# shellcheck source=SCRIPTDIR/one_address.sh
. "$(dirname "$0")/one_address.sh"
robots=${ROBOTS:-10}
settled=${SETTLED:-60}
rest=${REST:-30}
limit=${LIMIT:-0}
profiles="wifi wifi-secure"
if [ "${1:-}" = -k ]; then
  profiles=$2
  shift 2
fi
[ $# -gt 0 ] || set -- 0 10 30

# The other end of the wire is the localizer's computer.
unshare --net sleep infinity &
there=$!
children="$children $there"
until [ "$(readlink /proc/$there/ns/net)" != "$(readlink /proc/self/ns/net)" ]; do :; done
ip link set wire netns "$there"
cloud_side() { nsenter --net="/proc/$there/ns/net" "$@"; }
cloud_side ip link set lo up
cloud_side ip address add 10.88.0.2/24 dev wire
cloud_side ip link set wire up
cloud_side ip route add default dev wire
printf '127.0.0.1 localhost\n10.88.0.2 localizer_1\n' >"$scratch/hosts"

keys() { "$root/deploy/security/fleet-keys.sh" --dir "$scratch/fleet" "$@" >/dev/null; }
keys ca
keys localizer localizer_1
[ "$robots" -gt 1 ] || fail "ROBOTS: at least 2"
i=0
while [ $i -lt "$robots" ]; do
  i=$((i + 1))
  keys robot "robot_$i"
done

# lose SIDE DEVICE: each packet that comes in there, before anything puts fragments together.
lose() {
  side=$1
  device=$2
  $side nft flush ruleset
  [ "$loss" != 0 ] || return 0
  $side nft add table netdev lossy
  $side nft add chain netdev lossy in "{ type filter hook ingress device $device priority 0; }"
  $side nft add rule netdev lossy in ether type ip numgen random mod 100 \< "$loss" drop
}
robot_side() { "$@"; }

measure() {
  qos=$1
  loss=$2
  lose robot_side eth0
  lose cloud_side wire
  for_cloud=""
  for_robots=""
  case $qos in
    *-secure*)
      for_cloud="--security $scratch/fleet/localizers/localizer_1"
      for_robots="--security $scratch/fleet/robots"
      ;;
  esac
  # shellcheck disable=SC2086  # words on purpose
  nsenter --net="/proc/$there/ns/net" "$bin/fleetloc-cloud" --name localizer_1 --map "$scratch/map.pcd" --out "$scratch/cloud" \
    --qos "$root/qos_profiles/$qos.xml" $for_cloud >"$scratch/cloud.log" 2>&1 &
  cloud=$!
  # shellcheck disable=SC2086
  "$bin/fleet_robot" --robot-id robot --count "$robots" --qos "$root/qos_profiles/$qos.xml" \
    $for_robots --submaps "${SUBMAPS:-0}" --settled "$settled" --rest "$rest" >"$scratch/robots" 2>&1 &
  one=$!
  children="$there $cloud $one"
  wait $one || fail "robots: $(tail -n 1 "$scratch/robots")"
  kill -TERM $cloud
  wait $cloud || fail "localizer: $(tail -n 1 "$scratch/cloud.log")"
  children=$there
  sort -k6,6g "$scratch/robots" | awk -v qos="$qos" -v loss="$loss" -v limit="$limit" -v all="$robots" '
    $1 == "chosen" && !($2 in answered) { answered[$2] = $4 + $5; next }
    NF == 6 && $6 >= 0 { found[++n] = $6; for (i = 2; i <= 5; ++i) sum[i] += $i }
    END {
      a = 0
      for (id in answered) if (answered[id] > a) a = answered[id]
      printf "%-18s %4d %5d %7.1f %7.1f %8.1f %9.1f %9.1f %8.0f %8.0f\n", qos, loss, n, found[int((n + 1) / 2)],
        found[n], a, sum[2] / n / 1e3, sum[3] / n / 1e3, sum[4] / n, sum[5] / n
      if (limit > 0 && (n < all || found[n] > limit)) exit 1
    }'
}

printf '%-18s %4s %5s %7s %7s %8s %9s %9s %8s %8s\n' profile loss found "median" "last s" "answer s" \
  "start up" "down kB" "rest up" "down"
for qos in $profiles; do
  for loss in "$@"; do measure "$qos" "$loss"; done
done
