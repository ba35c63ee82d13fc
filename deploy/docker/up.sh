#!/bin/sh
# The demo's fleet in containers.
set -eu

usage() {
  cat <<'TEXT'
usage: deploy/docker/up.sh [--robots N] [--insecure] [--packages | --no-build] [--out DIR]

Builds the images fleetloc-robot, fleetloc-cloud and fleetloc-tools, then runs the demo's made-up
world (see deploy/demo.sh) in containers: two localizers and N robots on networks of their own, each
robot with its poor link, and with drivers that play what it sees as topics of ROS 2. Writes run
folders, logs and report.html to DIR. Needs Docker, and either `docker compose` or `docker-compose`.
World and map are kept in volumes for the next time. Each robot and localizer has keys of its own (DDS
Security), which are made for this run, are seen by nobody else, and go with it.

--robots N   1 to 200, default 2; half of them drive one way, half the other
--insecure   without keys: nothing is encrypted
--packages   does not compile: takes the packages that are in build/packages (deploy/package.sh)
--no-build   takes the images as they are
--out DIR    default: out/docker
FLEETLOC_BASE is the image to start from (debian:bookworm-slim); deploy/docker/base-image.sh makes it
on a site without a registry. FLEETLOC_PROJECT names containers, networks and volumes (fleetloc).
TMPDIR is where the keys are meanwhile (/tmp), which Docker's daemon must see.
TEXT
}

refuse() {
  echo "up.sh: $1" >&2
  exit 2
}

here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
out=$root/out/docker robots=2 build=source security=on
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage; exit 0 ;;
    --packages) build=given ;;
    --no-build) build=none ;;
    --insecure) security=off ;;
    --robots | --out)
      [ $# -ge 2 ] || refuse "$1 needs a value"
      if [ "$1" = --out ]; then out=$2; else robots=$2; fi
      shift ;;
    *) refuse "unknown option $1 (see --help)" ;;
  esac
  shift
done
case $robots in  # each robot of a site has a domain of ROS 2, of 100
  '' | 0* | *[!0-9]* | ????* | 2?[1-9] | 2[1-9]? | [3-9]??)
    refuse "--robots: '$robots' is not a number from 1 to 200" ;;
esac
project=${FLEETLOC_PROJECT:-fleetloc}
base=${FLEETLOC_BASE:-debian:bookworm-slim}
export FLEETLOC_BASE="$base" FLEETLOC_PACKAGES="$build" FLEETLOC_SECURITY="$security"
if [ $security = off ]; then export FLEETLOC_PROFILE=nbiot-peers; else unset FLEETLOC_PROFILE; fi

command -v docker >/dev/null || refuse "needs Docker (on Debian: apt-get install docker.io)"
docker info >/dev/null 2>&1 || refuse "no Docker daemon answers, or not to this user (docker info)"
if docker compose version >/dev/null 2>&1; then
  compose="docker compose"
elif command -v docker-compose >/dev/null; then
  compose=docker-compose
else
  refuse "needs docker compose or docker-compose (on Debian: apt-get install docker-compose)"
fi
compose() {
  # shellcheck disable=SC2086  # one word or two
  $compose -p "$project" --project-directory "$here" -f "$out/fleet-compose.yml" "$@" </dev/null
}
case $build in
  none)
    for part in robot cloud tools; do
      docker image inspect "fleetloc-$part" >/dev/null 2>&1 ||
        refuse "--no-build: there is no image fleetloc-$part"
    done
    ;;
  given)
    for part in robot cloud tools; do
      set -- "$root/build/packages/fleetloc-$part"_*.deb
      [ -f "$1" ] || refuse "--packages: no fleetloc-$part in build/packages (deploy/package.sh)"
    done
    ;;
esac
mkdir -p "$out" 2>/dev/null || refuse "$out: cannot be made"
out=$(cd "$out" && pwd)
log=$out/up.log
exec 9>"$out/.lock"
! command -v flock >/dev/null || flock -n 9 || refuse "$out: another fleet is running there"
: >"$log"

# Runs a command that talks to Docker; what it says is of interest only if it fails.
quietly() {
  "$@" >>"$log" 2>&1 || {
    tail -n 15 "$log" >&2
    fail "$* failed, see $log"
  }
}
fail() {
  echo "up.sh: $1" >&2
  exit 1
}
monitor=$project-monitor
end() {
  trap - EXIT
  trap '' INT TERM HUP
  remove_keys
  docker rm -f "$monitor" >/dev/null 2>&1 || true
  compose down --timeout 20 >>"$log" 2>&1 || true
}
FLEETLOC_KEYS=$(cd "$(mktemp -d)" && pwd)
has_keys=no
export FLEETLOC_KEYS
trap end EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP

begin() {
  echo "== $1"
  since=$(date +%s)
}
finish() { echo "   $(($(date +%s) - since)) s"; }

build_images() {
  if ! docker image inspect "$base" >/dev/null 2>&1 && ! docker pull "$base" >>"$log" 2>&1; then
    fail "no image $base here, and none to be pulled: make one with deploy/docker/base-image.sh"
  fi
  for part in tools cloud robot; do
    echo "   fleetloc-$part"
    quietly docker build -f "$here/Dockerfile" --target "$part" -t "fleetloc-$part" \
      --build-arg "BASE=$base" --build-arg "PACKAGES=$build" "$root"
  done
}

# What each robot is called, which services are its own and its drivers', where it writes, how it has
# really moved.
name_robots() {
  east=$(((robots + 1) / 2)) west=$((robots / 2))
  ids='' robot_services='' driver_services='' runs='' truths=''
  for site in "east $east robot_1" "west $west robot_2"; do
    # shellcheck disable=SC2086  # three words
    set -- $site
    number=1
    while [ "$number" -le "$2" ]; do
      ids="$ids $1_$number"
      robot_services="$robot_services robot_$1_$number"
      driver_services="$driver_services drivers_$1_$number"
      runs="$runs /runs/$1_$number"
      truths="$truths /world/truth/$3.csv"
      number=$((number + 1))
    done
  done
}

# Runs a shell script as root of a container, where the folder of keys is /keys: only that can give
# them to the user of the other containers, and take them away.
with_keys() {  # SCRIPT WORD...
  docker run --rm --pull never --network none --user 0 --volume "$FLEETLOC_KEYS:/keys" \
    fleetloc-tools sh -euc "$@" </dev/null
}
remove_keys() {
  [ $has_keys = no ] || with_keys 'rm -rf /keys/*' >>"$log" 2>&1 || true
  rm -rf "$FLEETLOC_KEYS" 2>>"$log" || echo "up.sh: keys are left in $FLEETLOC_KEYS" >&2
}

# For this run only: nobody can make further members afterwards.
issue_keys() {
  # shellcheck disable=SC2016  # the words of the container
  with_keys '
    keys() { /usr/share/fleetloc/security/fleet-keys.sh --dir /keys --days 7 "$@"; }
    keys ca --fleet fleetloc
    for name in localizer_1 localizer_2; do keys localizer "$name"; done
    for name in $0; do keys robot "$name"; done
    rm -r /keys/ca
    chown -R fleetloc:fleetloc /keys/robots /keys/localizers' "$ids"
}
make_keys() {
  if [ $security = on ]; then
    has_keys=yes
    quietly issue_keys
  else  # what would be mounted
    for member in localizers/localizer_1 localizers/localizer_2 $ids; do
      case $member in */*) ;; *) member=robots/$member ;; esac
      mkdir -p "$FLEETLOC_KEYS/$member"
    done
  fi
}

state() { docker inspect -f '{{.State.Status}} {{.State.ExitCode}} {{.Name}}' "$@"; }

# Until all drivers have played to the end; nobody else may end before.
wait_for_drivers() {
  # shellcheck disable=SC2086  # lists
  drivers=$(compose ps -q $driver_services 2>>"$log")
  # shellcheck disable=SC2086
  robot_containers=$(compose ps -q $robot_services 2>>"$log")
  localizers=$(compose ps -q localizer_1 localizer_2 2>>"$log")
  while :; do
    # shellcheck disable=SC2086  # lists
    ended=$(state $localizers $robot_containers | grep -v '^r' || true)
    [ -z "$ended" ] || fail "ended too early: $ended$(last_words)"
    # shellcheck disable=SC2086
    states=$(state $drivers)
    failed=$(echo "$states" | grep '^exited' | grep -v '^exited 0 ' || true)
    [ -z "$failed" ] || fail "drivers have failed: $failed$(last_words)"
    echo "$states" | grep -qv '^exited 0 ' || return 0
    sleep 1
  done
}
last_words() {
  # shellcheck disable=SC2086  # lists
  compose logs --tail 3 localizer_1 localizer_2 $robot_services $driver_services 2>/dev/null | sed 's/^/\n  /'
}

stop() {  # WHAT CONTAINERS SERVICE...
  what=$1 containers=$2
  shift 2
  since_stop=$(date +%s)
  quietly compose stop --timeout 20 "$@"
  # shellcheck disable=SC2086
  failed=$(state $containers | grep -v '^exited 0 ' || true)
  [ -z "$failed" ] || fail "has not ended cleanly: $failed"
  echo "   $what ended within $(($(date +%s) - since_stop)) s of SIGTERM"
}

name_robots
awk -v east="$east" -v west="$west" -f "$here/robots.awk" "$here/compose.yml" >"$out/fleet-compose.yml"
if [ $build != none ]; then
  begin "images, on $base"
  build_images
  finish
fi
docker image ls --format '{{.Repository}} {{.Size}}' | awk '/^fleetloc-(robot|cloud|tools) / {print "   " $0}'

compose down --remove-orphans >>"$log" 2>&1 || true
docker volume rm "${project}_runs" >/dev/null 2>&1 || true

begin "keys: $([ $security = on ] && echo "of a fleet that ends with this run" || echo none)"
make_keys
finish

begin "world: a survey in summer, the map made of it, and what the robots will see in autumn"
compose run --rm -T world 2>>"$log" || fail "no world, see $log"
finish

begin "run: 2 localizers, robots$ids"
# shellcheck disable=SC2086  # lists
quietly compose up -d --no-build localizer_1 localizer_2 $robot_services $driver_services
# shellcheck disable=SC2086  # lists
compose run --rm -T --name "$monitor" tools fleetloc-monitor --run $runs --ground-truth $truths \
  --localizer /runs/localizer_1 /runs/localizer_2 2>>"$log" &
watch=$!
wait_for_drivers
# shellcheck disable=SC2086
stop "all robots" "$robot_containers" $robot_services
wait "$watch" || fail "the monitor failed"
stop "both localizers" "$localizers" localizer_1 localizer_2
finish

begin report
# shellcheck disable=SC2086
compose run --rm -T tools fleetloc-eval --run $runs --ground-truth $truths \
  --report /runs/report.html --map /world/map/map.pcd \
  --sessions /runs/localizer_1/sessions.json /runs/localizer_2/sessions.json 2>>"$log" ||
  fail "no report, see $log"
quietly docker cp "$(echo "$localizers" | head -n 1):/runs/." "$out"
for id in $ids; do
  [ -s "$out/$id/localization_frames.tum" ] || fail "$id has never been localized"
done
finish
echo "run folders and logs: $out"
echo "report: $out/report.html"
