#!/bin/sh
# packages.sh: the packages of build/packages (deploy/package.sh) installed, run by systemd, upgraded,
# removed and purged, in a container of Debian 12. Without keys a service is refused in one line; with
# them it has its own copies and serves; another setting turns security off, and its log says so. Each
# expectation names itself when it fails. Needs root, Docker and the image FLEETLOC_BASE
# (debian:bookworm-slim).
set -eu

root=$(cd "$(dirname "$0")/../.." && pwd)
base=${FLEETLOC_BASE:-debian:bookworm-slim}
name=fleetloc-packages-$$
scratch=$(mktemp -d)

fail() {
  echo "packages.sh: $1" >&2
  exit 1
}
end() {
  trap - EXIT INT TERM HUP
  docker rm -f "$name" >/dev/null 2>&1 || true
  [ -z "${unmount:-}" ] || umount "$unmount"
  rm -rf "$scratch"
}
trap end EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP

[ "$(id -u)" = 0 ] || fail "needs root"
for part in robot cloud tools; do
  set -- "$root/build/packages/fleetloc-$part"_*.deb
  [ -f "$1" ] || fail "no fleetloc-$part in build/packages: deploy/package.sh"
  cp "$1" "$scratch/$part.deb"
done
docker image inspect "$base" >/dev/null 2>&1 || fail "no image $base: deploy/docker/base-image.sh"

# What the packages need, and systemd; layers that stay for the next time.
cat >"$scratch/Dockerfile" <<DOCKERFILE
FROM $base
RUN apt-get update -qq && apt-get install -y -qq --no-install-recommends systemd systemd-sysv openssl
COPY robot.deb cloud.deb /packages/
RUN for part in robot cloud; do \\
  apt-get satisfy -y -qq --no-install-recommends "\$(dpkg-deb -f /packages/\$part.deb Depends)" || exit 1; done
CMD ["/sbin/init"]
DOCKERFILE
docker build -t fleetloc-packages-test "$scratch" >"$scratch/build.log" 2>&1 ||
  fail "no image: $(tail -n 3 "$scratch/build.log")"

# Systemd in a container wants its own hierarchy where the kernel still has several (cgroup v1).
if [ ! -e /sys/fs/cgroup/cgroup.controllers ] && [ ! -d /sys/fs/cgroup/systemd ]; then
  mkdir /sys/fs/cgroup/systemd
  mount -t cgroup -o none,name=systemd cgroup /sys/fs/cgroup/systemd
  unmount=/sys/fs/cgroup/systemd
fi
docker run -d --name "$name" --cap-add SYS_ADMIN --security-opt seccomp=unconfined --security-opt apparmor=unconfined \
  --network none --hostname computer --tmpfs /run --tmpfs /run/lock \
  --volume /sys/fs/cgroup:/sys/fs/cgroup:rw --entrypoint /sbin/init fleetloc-packages-test >/dev/null
in_it() { docker exec "$name" "$@"; }
tries=0
until in_it systemctl is-system-running 2>/dev/null | grep -q 'running\|degraded'; do
  tries=$((tries + 1))
  [ $tries -lt 60 ] || fail "systemd does not run: $(docker logs "$name" 2>&1 | tail -n 3)"
  sleep 0.5
done

# shellcheck source=test/expect.sh
. "$root/test/expect.sh"
begin_log() { in_it sh -c 'journalctl --rotate -q; journalctl --vacuum-time=1s -q' 2>/dev/null; }
log_of() { in_it journalctl -o cat -q -u "fleetloc-$1" | grep '^fleetloc-\|^localizer_1' || true; }
logs() { log_of "$1" | grep -qF -- "$2" || { log_of "$1" >&2; return 1; }; }
# starts PART CODE: the service is started, and has ended with that code; 0: it runs.
starts() {
  in_it systemctl reset-failed "fleetloc-$1" 2>/dev/null || true
  in_it systemctl restart "fleetloc-$1" 2>/dev/null || true
  [ "$(in_it systemctl show -P ExecMainStatus "fleetloc-$1")" = "$2" ] || return 1
  [ "$2" != 0 ] || in_it systemctl -q is-active "fleetloc-$1"
}
install() { in_it dpkg -i "/packages/$1.deb"; }

# No user namespaces within this container.
for part in robot cloud; do
  in_it mkdir -p "/etc/systemd/system/fleetloc-$part.service.d"
  in_it sh -c "printf '[Service]\nPrivateUsers=no\n' >/etc/systemd/system/fleetloc-$part.service.d/container.conf"
done
for part in robot cloud; do install $part >"$scratch/$part.said" 2>&1 || fail "$(cat "$scratch/$part.said")"; done
for part in robot cloud; do
  keys=/etc/fleetloc/$part-keys
  expect "installing $part says where the keys belong" grep -q "fleetloc-$part: starts when its keys are in $keys" "$scratch/$part.said"
  expect "the folder for the keys of $part is root's only" test "$(in_it stat -c '%U:%G %a' $keys)" = "root:root 700"
  expect "$part without keys does not start" starts $part 2
done
refused="no keys in /etc/fleetloc/cloud-keys: make them with 'fleet-keys.sh localizer computer'"
expect "it says why in one line" logs cloud "$refused"
expect "once" test "$(log_of cloud | grep -c fleet-keys)" = 1
expect "and not again: a setting does not come by waiting" test "$(in_it systemctl show -P NRestarts fleetloc-cloud)" = 0

# A localizer with a map of three planes, and the keys that its name asks for.
awk 'BEGIN {
  print "ply\nformat ascii 1.0\nelement vertex 1200"
  print "property float x\nproperty float y\nproperty float z\nend_header"
  for (i = 0; i < 20; ++i) for (j = 0; j < 20; ++j) {
    print i / 5, j / 5, 0; print i / 5, 0, j / 5; print 0, i / 5, j / 5 }
}' >"$scratch/room.ply"
"${BUILD:-$root/build/release}/bin/fleetloc-map" build --cloud "$scratch/room.ply" --out "$scratch/map.pcd" >/dev/null
in_it mkdir -p /srv/fleetloc
docker cp "$scratch/map.pcd" "$name:/srv/fleetloc/" >/dev/null
docker cp "$scratch/map.yaml" "$name:/srv/fleetloc/" >/dev/null
keys() { "$root/deploy/security/fleet-keys.sh" --dir "$scratch/fleet" "$@" >/dev/null; }
keys ca
keys localizer localizer_1
keys localizer localizer_2
keys robot robot_1
set_option() { in_it sed -i "s|^#*$1=.*|$1=$2|" "/etc/fleetloc/${3:-cloud}.env"; }
put_keys() { docker cp "$scratch/fleet/localizers/$1/." "$name:/etc/fleetloc/cloud-keys" >/dev/null; }
set_option FLEETLOC_NAME localizer_1
put_keys localizer_2
expect "keys of another member are refused" starts cloud 2
expect "with their file and name" logs cloud "is of localizer 'localizer_2', not of localizer 'localizer_1'"
put_keys localizer_1
expect "with its keys it serves" starts cloud 0
expect "by a secure profile" sh -c "docker exec $name sh -c 'tr \"\\0\" \" \" <\"/proc/\$(systemctl show -P MainPID fleetloc-cloud)/cmdline\"' | grep -q 'wifi-secure.xml --security /run/fleetloc-cloud/keys'"
expect "its keys are nobody else's" test -z "$(in_it sh -c 'su -s /bin/sh nobody -c "cat /etc/fleetloc/cloud-keys/key.pem /run/fleetloc-cloud/keys/key.pem" 2>/dev/null')"
expect "and are in no log" not sh -c "docker exec $name journalctl -o cat -q | grep -q PRIVATE"

install cloud >"$scratch/said" 2>&1 || fail "upgrade: $(cat "$scratch/said")"
expect "after an upgrade it serves on" in_it systemctl -q is-active fleetloc-cloud
expect "and nothing is asked for" not grep -q "starts when" "$scratch/said"
expect "keys that came with another's owner are root's after it" test \
  "$(in_it stat -c '%U:%G %a' /etc/fleetloc/cloud-keys/key.pem)" = "root:root 600"

set_option FLEETLOC_ROBOT_ID robot_1 robot
set_option FLEETLOC_SENSORS /usr/share/fleetloc/robot/sensors-play.yaml robot
docker cp "$scratch/fleet/robots/robot_1/." "$name:/etc/fleetloc/robot-keys" >/dev/null
expect "a robot with keys gets as far as its sensors" starts robot 2
expect "which the example does not say" logs robot "DATASET"

begin_log
set_option FLEETLOC_SECURITY off
expect "security can be turned off" starts cloud 0
expect "which the log says" logs cloud "FLEETLOC_SECURITY=off: nothing is encrypted"
in_it rm -r /etc/fleetloc/cloud-keys
in_it mkdir /etc/fleetloc/cloud-keys
expect "then it needs no keys" starts cloud 0
set_option FLEETLOC_SECURITY on
install cloud >"$scratch/said" 2>&1 || fail "an upgrade to security without keys: $(cat "$scratch/said")"
expect "an upgrade that leaves it without keys says so" grep -q "fleetloc-cloud: does not start" "$scratch/said"

put_keys localizer_1
in_it dpkg -r fleetloc-cloud >"$scratch/said" 2>&1
expect "removal keeps keys and says so" grep -q "the keys stay in /etc/fleetloc/cloud-keys" "$scratch/said"
expect "they are there" in_it test -f /etc/fleetloc/cloud-keys/key.pem
in_it dpkg -P fleetloc-cloud >"$scratch/said" 2>&1
expect "purge deletes them and says so" grep -q "deletes the keys in /etc/fleetloc/cloud-keys" "$scratch/said"
expect "the robot's stay" in_it test -d /etc/fleetloc/robot-keys
in_it dpkg -P fleetloc-robot >/dev/null 2>&1
expect "purge leaves nothing" test -z "$(in_it sh -c 'ls -d /etc/fleetloc* /var/lib/fleetloc* /var/lib/private/fleetloc* /usr/share/fleetloc* /usr/bin/fleetloc* 2>/dev/null')"

[ "$failures" = 0 ] || exit 1
echo "packages: all as expected"
