#!/bin/sh
# discovery.sh [-k "PROFILE..."] [ROBOTS...]      e.g. discovery.sh -k "lan lan-server" 2 10 50 100
# What discovery costs: so many robots (test/fleet/fleet_robot.cpp, TOGETHER in a process, 25 by
# default) and two localizers, all on one address of a network of their own, with each of the QoS
# profiles. Prints a table; needs root for the network namespace, and fast-discovery-server for the
# profiles -server. SETTLED and REST are seconds, see fleet_robot --help; STAGGER those between the
# starts of two processes. With LIMIT it fails if a
# robot is not found, or if one at rest sends or receives more bytes per second than that.
set -eu

# A test that cannot run here is skipped, not failed.
if [ -n "${SKIP:-}" ]; then
  command -v fast-discovery-server >/dev/null && unshare --net --mount true 2>/dev/null || exit "$SKIP"
fi
. "$(dirname "$0")/one_address.sh"
settled=${SETTLED:-60}
rest=${REST:-30}
together=${TOGETHER:-25}
stagger=${STAGGER:-0}
limit=${LIMIT:-0}

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
  start_cloud "$qos" localizer_2
  clouds=$cloud
  start_cloud "$qos" localizer_1
  clouds="$clouds $cloud"
  robots=""
  spent=0
  i=0
  while [ $i -lt "$count" ]; do
    here=$together
    [ $((count - i)) -ge "$here" ] || here=$((count - i))
    "$bin/fleet_robot" --robot-id "robot_$i" --count "$here" --qos "$root/qos_profiles/$qos.xml" \
      --settled "$settled" --rest "$rest" >"$scratch/robot_$i" 2>&1 &
    robots="$robots $!"
    i=$((i + here))
    [ "$stagger" = 0 ] || sleep "$stagger"
    spent=$((spent + stagger))
  done
  children="$children $robots"
  start_cpu=$(cpu_of $cloud)
  sleep $((settled - spent))
  settled_cpu=$(cpu_of $cloud)
  robots_memory=0
  for pid in $robots; do robots_memory=$((robots_memory + $(memory_of "$pid"))); done
  [ -z "$server" ] || server_cpu=$(cpu_of "$server")
  sleep "$rest"
  end_cpu=$(cpu_of $cloud)
  memory=$(memory_of $cloud)
  server_words="- -"
  [ -z "$server" ] ||
    server_words="$(memory_of "$server") $(cpu_of "$server" | awk -v a="$server_cpu" -v t="$rest" '{ print 100 * ($1 - a) / t }')"
  for pid in $robots; do wait "$pid" || true; done
  # shellcheck disable=SC2086
  kill -TERM $clouds $server
  for pid in $clouds; do wait "$pid" || true; done
  [ -z "$server" ] || wait "$server" || true
  children=""
  cat "$scratch"/robot_* | sort -k1,1 >"$scratch/all"
  rm -f "$scratch"/robot_*
  # shellcheck disable=SC2086
  report "$qos" "$count" "$memory" "$(echo "$start_cpu $settled_cpu $end_cpu" |
    awk -v s="$settled" -v t="$rest" '{ print 100 * ($2 - $1) / s, 100 * ($3 - $2) / t }')" $server_words \
    "$(awk -v m="$robots_memory" -v n="$count" 'BEGIN { printf "%.1f", m / n }')"
}

# Means over the robots; the latest of the times.
report() {
  # shellcheck disable=SC2086,SC2048
  awk -v words="$*" -v limit="$limit" 'NF == 6 && $6 >= 0 { ++n; for (i = 2; i <= 5; ++i) sum[i] += $i; if ($6 > last) last = $6 }
    END {
      split(words, w, " ")
      printf "%-12s %6d %5d %9.1f %9.1f %8.0f %8.0f %7.1f %6s %8.1f %7.1f %7s %7s %7s\n", w[1], w[2], n,
        sum[2] / n / 1e3, sum[3] / n / 1e3, sum[4] / n, sum[5] / n, last, w[3], w[4], w[5], w[6],
        w[7] == "-" ? w[7] : sprintf("%.1f", w[7]), w[8]
      if (limit > 0 && (n < w[2] || sum[4] / n > limit || sum[5] / n > limit)) exit 1
    }' "$scratch/all"
}

echo "per robot: start = kB in the first 12 s, rest = B/s; cpu = % of a core while $settled s settle, and at rest"
printf "%-12s %6s %5s %9s %9s %8s %8s %7s %6s %8s %7s %7s %7s %7s\n" profile robots found "start up" "down" \
  "rest up" "down" "found s" "MB" "cpu" "at rest" "srv MB" "cpu" "rob. MB"
for qos in $profiles; do
  for count in "$@"; do measure "$qos" "$count"; done
done
