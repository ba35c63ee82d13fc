#!/bin/sh
# narrow_line.sh [-k "PROFILE..."] [RUNS]      e.g. narrow_line.sh -k "nbiot-peers nbiot-secure-peers" 5
# How long robots take to meet localizers over a narrow line: two robots (test/fleet/fleet_robot.cpp),
# which send submaps as soon as they can, and two localizers, each with an address and a network of its
# own, all started at once. The robots' links are emulated: LINK (deploy/worlds/demo/link.yaml: 4 KB/s
# each way, 0.5 s, 10 % lost) with another seed each time. Prints, for each robot, when it had its
# localizer and that one's first answer, and its bytes up to START s (30). With LIMIT it fails if one
# takes longer to have its localizer [s]. Needs root.
set -eu

# shellcheck source=SCRIPTDIR/one_address.sh
. "$(dirname "$0")/one_address.sh"
link=${LINK:-$root/deploy/worlds/demo/link.yaml}
limit=${LIMIT:-0}
settled=${SETTLED:-45}
profiles=nbiot-secure-peers
if [ "${1:-}" = -k ]; then
  profiles=$2
  shift 2
fi
runs=${1:-5}

# A switch, to which the robots and both localizers are connected.
ip link add switch type bridge
ip address flush dev eth0
ip address add 10.88.0.1/24 dev switch
ip link set wire master switch
ip link set switch up
ip route replace default dev switch
computers=""
for number in 1 2; do
  unshare --net sleep infinity &
  computer=$!
  computers="$computers $computer"
  children="$children $computer"
  until [ "$(readlink /proc/$computer/ns/net)" != "$(readlink /proc/self/ns/net)" ]; do :; done
  ip link add "port$number" type veth peer name "wire$number"
  ip link set "port$number" master switch
  ip link set "port$number" up
  ip link set "wire$number" netns "$computer"
  nsenter --net="/proc/$computer/ns/net" sh -c "
    ip link set lo up
    ip address add 10.88.0.$((number + 1))/24 dev wire$number
    ip link set wire$number up
    ip route add default dev wire$number"
done
printf '127.0.0.1 localhost\n10.88.0.2 localizer_1\n10.88.0.3 localizer_2\n' >"$scratch/hosts"

keys() { "$root/deploy/security/fleet-keys.sh" --dir "$scratch/fleet" "$@" >/dev/null; }
keys ca
for number in 1 2; do
  keys localizer "localizer_$number"
  keys robot "robot_$number"
done

measure() {  # PROFILE RUN
  secure=""
  case $1 in *-secure*) secure=yes ;; esac
  qos=$root/qos_profiles/$1.xml
  localizers=""
  number=0
  for computer in $computers; do
    number=$((number + 1))
    nsenter --net="/proc/$computer/ns/net" "$bin/fleetloc-cloud" --name "localizer_$number" \
      --map "$scratch/map.pcd" --out "$scratch/cloud_$number" --qos "$qos" \
      ${secure:+--security "$scratch/fleet/localizers/localizer_$number"} >"$scratch/cloud_$number.log" 2>&1 &
    localizers="$localizers $!"
  done
  robots=""
  for number in 1 2; do
    sed "s/^seed:.*/seed: $((10 * $2 + number))/" "$link" >"$scratch/link_$number.yaml"
    "$bin/fleet_robot" --robot-id "robot_$number" --qos "$qos" --link "$scratch/link_$number.yaml" \
      ${secure:+--security "$scratch/fleet/robots"} --submaps "${SUBMAPS:-2}" --start "${START:-30}" \
      --settled "$settled" --rest 1 >"$scratch/robot_$number" 2>&1 &
    robots="$robots $!"
  done
  children="$computers $localizers $robots"
  for robot in $robots; do
    wait "$robot" || fail "a robot: $(tail -qn 1 "$scratch/robot_1" "$scratch/robot_2")"
  done
  # shellcheck disable=SC2086  # words on purpose
  kill -TERM $localizers
  for localizer in $localizers; do
    wait "$localizer" || fail "a localizer: $(tail -qn 1 "$scratch/cloud_1.log" "$scratch/cloud_2.log")"
  done
  children=$computers
  cat "$scratch/robot_1" "$scratch/robot_2" | awk -v profile="$1" -v run="$2" -v limit="$limit" '
    $1 == "chosen" && !($2 in answered) { answered[$2] = sprintf("%.1f", $4 + $5) }
    NF == 6 && $1 != "chosen" {
      late += limit > 0 && ($6 < 0 || $6 > limit)
      printf "%-20s %4d %-8s %8s %9s %8.1f %8.1f\n", profile, run, $1, $6 < 0 ? "never" : sprintf("%.1f", $6),
        $1 in answered ? answered[$1] : "never", $2 / 1e3, $3 / 1e3
    }
    END { exit late > 0 }' || late=yes
}

printf '%-20s %4s %-8s %8s %9s %8s %8s\n' profile run robot "found s" "answer s" "up kB" "down kB"
late=""
for profile in $profiles; do
  run=0
  while [ $run -lt "$runs" ]; do
    run=$((run + 1))
    measure "$profile" "$run"
  done
done
[ -z "$late" ] || fail "somebody took longer than $limit s"
