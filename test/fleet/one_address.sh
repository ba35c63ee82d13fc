# For the scripts here, which source it as their first act: everything that they start is on one
# address of a network of its own, where the profiles' host names are that address. Sets root, bin
# and scratch; children are ended with the script. Needs root, for the network namespace.
# BUILD (default build/release) has the programs.
# shellcheck shell=sh

root=$(cd "$(dirname "$0")/../.." && pwd)
bin=${BUILD:-$root/build/release}/bin

fail() {
  echo "$(basename "$0"): $1" >&2
  exit 1
}

if [ -z "${FLEETLOC_INSIDE:-}" ]; then
  [ "$(id -u)" = 0 ] || fail "needs root"
  [ -x "$bin/fleet_robot" ] || fail "$bin/fleet_robot is not built"
  FLEETLOC_INSIDE=1 exec unshare --net --mount --propagation private "$0" "$@"
fi

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
ip address add 10.88.0.1/24 dev eth0
ip link set wire up
ip link set eth0 up
ip route add default dev eth0
printf '127.0.0.1 localhost\n10.88.0.1 localizer_1 localizer_2 discovery\n' >"$scratch/hosts"
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

# start_server PROFILE: the discovery server, if the profile wants one; `server` is its process.
start_server() {
  server=""
  case $1 in
    *-server)
      fast-discovery-server -i 0 -l 0.0.0.0 -p 11811 -x "server@$root/qos_profiles/server.xml" \
        >/dev/null 2>&1 &
      server=$!
      ;;
  esac
  children="$children $server"
}

# start_cloud PROFILE NAME: `cloud` is its process.
start_cloud() {
  "$bin/fleetloc-cloud" --name "$2" --map "$scratch/map.pcd" --out "$scratch/$2" \
    --qos "$root/qos_profiles/$1.xml" >"$scratch/$2.log" 2>&1 &
  cloud=$!
  children="$children $cloud"
}
