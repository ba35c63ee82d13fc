#!/bin/sh
# discovery.sh [-k "PROFILE..."] [ROBOTS...]      e.g. discovery.sh -k "lan lan-server" 2 10 50 100
# What discovery costs: so many robots (test/fleet/fleet_robot.cpp, one process each) and one
# fleetloc-cloud, all on one address of a network of their own, with each of the QoS profiles. Prints a
# table; needs root for the network namespace, and fast-discovery-server for the profiles -server.
# BUILD (default build/release) has the programs; SETTLED and REST are seconds, see fleet_robot --help.
set -eu

root=$(cd "$(dirname "$0")/../.." && pwd)
bin=${BUILD:-$root/build/release}/bin
settled=${SETTLED:-60}
rest=${REST:-30}
address=10.88.0.1

fail() {
  echo "discovery.sh: $1" >&2
  exit 1
}

# Everything happens in a network of its own, in which the profiles' host names are this one.
if [ -z "${FLEETLOC_DISCOVERY_INSIDE:-}" ]; then
  [ "$(id -u)" = 0 ] || fail "needs root"
  [ -x "$bin/fleet_robot" ] || fail "$bin/fleet_robot is not built"
  FLEETLOC_DISCOVERY_INSIDE=1 exec unshare --net --mount --propagation private "$0" "$@"
fi
profiles="lan lan-server"
if [ "${1:-}" = -k ]; then
  profiles=$2
  shift 2
fi
[ $# -gt 0 ] || set -- 2 10 50 100

scratch=$(mktemp -d)
children=""
end_all() {
  trap - EXIT INT TERM HUP
  # shellcheck disable=SC2086  # words on purpose
  [ -z "$children" ] || kill $children 2>/dev/null || true
  wait
  rm -rf "$scratch"
}
trap end_all EXIT
trap 'end_all; exit 130' INT
trap 'end_all; exit 143' TERM HUP

ip link set lo up
ip link add eth0 type veth peer name wire
ip address add "$address/24" dev eth0
ip link set wire up
ip link set eth0 up
ip route add default dev eth0
printf '127.0.0.1 localhost\n%s localizer_1 discovery\n' "$address" >"$scratch/hosts"
mount --bind "$scratch/hosts" /etc/hosts

# A floor and two walls: nobody localizes.
awk 'BEGIN {
  print "ply\nformat ascii 1.0\nelement vertex 1200"
  print "property float x\nproperty float y\nproperty float z\nend_header"
  for (i = 0; i < 20; ++i) for (j = 0; j < 20; ++j) {
    print i / 5, j / 5, 0; print i / 5, 0, j / 5; print 0, i / 5, j / 5 }
}' >"$scratch/room.ply"
"$bin/fleetloc-map" build --cloud "$scratch/room.ply" --out "$scratch/map.pcd" >"$scratch/map.log" ||
  fail "no map: $(cat "$scratch/map.log")"

# Seconds of processor time of a process.
cpu_of() {
  awk -v hz="$(getconf CLK_TCK)" '{ sub(/.*\) /, ""); print ($12 + $13) / hz }' "/proc/$1/stat"
}
memory_of() {
  awk '/^VmRSS/ { printf "%.0f", $2 / 1024 }' "/proc/$1/status"
}

measure() {
  qos=$1
  count=$2
  server=""
  case $qos in
    *-server)
      fast-discovery-server -i 0 -l 0.0.0.0 -p 11811 >/dev/null 2>&1 &
      server=$!
      ;;
  esac
  "$bin/fleetloc-cloud" --name localizer_1 --map "$scratch/map.pcd" --out "$scratch/cloud" \
    --qos "$root/qos_profiles/$qos.xml" >"$scratch/cloud.log" 2>&1 &
  cloud=$!
  children="$server $cloud"
  robots=""
  i=0
  while [ $i -lt "$count" ]; do
    i=$((i + 1))
    "$bin/fleet_robot" --robot-id "robot_$i" --qos "$root/qos_profiles/$qos.xml" \
      --settled "$settled" --rest "$rest" >"$scratch/robot_$i" 2>&1 &
    robots="$robots $!"
  done
  children="$children $robots"
  start_cpu=$(cpu_of $cloud)
  sleep "$settled"
  settled_cpu=$(cpu_of $cloud)
  [ -z "$server" ] || server_cpu=$(cpu_of "$server")
  sleep "$rest"
  end_cpu=$(cpu_of $cloud)
  memory=$(memory_of $cloud)
  server_words="- -"
  [ -z "$server" ] ||
    server_words="$(memory_of "$server") $(cpu_of "$server" | awk -v a="$server_cpu" -v t="$rest" '{ print 100 * ($1 - a) / t }')"
  for pid in $robots; do wait "$pid" || true; done
  # shellcheck disable=SC2086
  kill -TERM $cloud $server
  wait $cloud || true
  [ -z "$server" ] || wait "$server" || true
  children=""
  cat "$scratch"/robot_* | sort -k1,1 >"$scratch/all"
  rm -f "$scratch"/robot_*
  # shellcheck disable=SC2086
  report "$qos" "$count" "$memory" "$(echo "$start_cpu $settled_cpu $end_cpu" |
    awk -v s="$settled" -v t="$rest" '{ print 100 * ($2 - $1) / s, 100 * ($3 - $2) / t }')" $server_words
}

# Means over the robots; the latest of the times.
report() {
  # shellcheck disable=SC2086,SC2048
  awk -v words="$*" 'NF == 6 && $6 >= 0 { ++n; for (i = 2; i <= 5; ++i) sum[i] += $i; if ($6 > last) last = $6 }
    END {
      split(words, w, " ")
      printf "%-12s %6d %5d %9.1f %9.1f %8.0f %8.0f %7.1f %6s %8.1f %7.1f %7s %7s\n", w[1], w[2], n,
        sum[2] / n / 1e3, sum[3] / n / 1e3, sum[4] / n, sum[5] / n, last, w[3], w[4], w[5], w[6],
        w[7] == "-" ? w[7] : sprintf("%.1f", w[7])
    }' "$scratch/all"
}

echo "per robot: start = kB in the first 12 s, rest = B/s; cpu = % of a core while $settled s settle, and at rest"
printf "%-12s %6s %5s %9s %9s %8s %8s %7s %6s %8s %7s %7s %7s\n" profile robots found "start up" "down" \
  "rest up" "down" "found s" "MB" "cpu" "at rest" "srv MB" "cpu"
for qos in $profiles; do
  for count in "$@"; do measure "$qos" "$count"; done
done
