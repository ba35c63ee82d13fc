#!/bin/sh
# discovery.sh [-k "PROFILE..."] [ROBOTS...]      e.g. discovery.sh -k "lan lan-server" 2 10 50 100
# What discovery costs: so many robots (test/fleet/fleet_robot.cpp, one process each) and one
# fleetloc-cloud, all on one address of a network of their own, with each of the QoS profiles. Prints a
# table; needs root for the network namespace, and fast-discovery-server for the profiles -server.
# SETTLED and REST are seconds, see fleet_robot --help.
set -eu

. "$(dirname "$0")/one_address.sh"
settled=${SETTLED:-60}
rest=${REST:-30}

profiles="lan lan-server"
if [ "${1:-}" = -k ]; then
  profiles=$2
  shift 2
fi
[ $# -gt 0 ] || set -- 2 10 50 100

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
  start_server "$qos"
  start_cloud "$qos" localizer_1
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
