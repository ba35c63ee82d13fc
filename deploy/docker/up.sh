#!/bin/sh
# The demo's fleet in containers.
set -eu

usage() {
  cat <<'TEXT'
usage: deploy/docker/up.sh [--robots N] [--packages | --no-build] [--out DIR]

Builds the images fleetloc-robot, fleetloc-cloud and fleetloc-tools, then runs the demo's made-up
world (see deploy/demo.sh) in containers: two localizers and N robots on networks of their own, each
robot with its poor link, and with drivers that play what it sees as topics of ROS 2. Writes run
folders, logs and report.html to DIR. Needs Docker, and either `docker compose` or `docker-compose`.
World and map are kept in volumes for the next time.

--robots N   1 to 200, default 2; half of them drive one way, half the other
--packages   does not compile: takes the packages that are in build/packages (deploy/package.sh)
--no-build   takes the images as they are
--out DIR    default: out/docker
FLEETLOC_BASE is the image to start from (debian:bookworm-slim); deploy/docker/base-image.sh makes it
on a site without a registry. FLEETLOC_PROJECT names containers, networks and volumes (fleetloc).
TEXT
}

refuse() {
  echo "up.sh: $1" >&2
  exit 2
}

here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
out=$root/out/docker robots=2 build=source
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage; exit 0 ;;
    --packages) build=given ;;
    --no-build) build=none ;;
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
export FLEETLOC_BASE="$base" FLEETLOC_PACKAGES="$build"

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
  $compose -p "$project" -f "$here/compose.yml" "$@" </dev/null
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
  trap - EXIT INT TERM HUP
  docker rm -f "$monitor" >/dev/null 2>&1 || true
  compose down --timeout 20 >>"$log" 2>&1 || true
}
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

# Sets robots, runs, truths: what each robot is called, where it writes, how it has really moved.
name_robots() {
  east=$(((robots + 1) / 2)) west=$((robots / 2))
  ids='' runs='' truths=''
  for site in "east $east robot_1" "west $west robot_2"; do
    # shellcheck disable=SC2086  # three words
    set -- $site
    number=1
    while [ "$number" -le "$2" ]; do
      ids="$ids $1_$number"
      runs="$runs /runs/$1_$number"
      truths="$truths /world/truth/$3.csv"
      number=$((number + 1))
    done
  done
}

state() { docker inspect -f '{{.State.Status}} {{.State.ExitCode}} {{.Name}}' "$@"; }

# Until all drivers have played to the end; nobody else may end before.
wait_for_drivers() {
  drivers=$(compose ps -q drivers_east drivers_west 2>>"$log")
  robot_containers=$(compose ps -q robot_east robot_west 2>>"$log")
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
  compose logs --tail 3 localizer_1 localizer_2 robot_east robot_west drivers_east drivers_west \
    2>/dev/null | sed 's/^/\n  /'
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

if [ $build != none ]; then
  begin "images, on $base"
  build_images
  finish
fi
docker image ls --format '{{.Repository}} {{.Size}}' | awk '/^fleetloc-(robot|cloud|tools) / {print "   " $0}'

compose down --remove-orphans >>"$log" 2>&1 || true
docker volume rm "${project}_runs" >/dev/null 2>&1 || true
name_robots

begin "world: a survey in summer, the map made of it, and what the robots will see in autumn"
compose run --rm -T world 2>>"$log" || fail "no world, see $log"
finish

begin "run: 2 localizers, robots$ids"
quietly compose up -d --no-build --scale "robot_east=$east" --scale "robot_west=$west" \
  --scale "drivers_east=$east" --scale "drivers_west=$west" \
  localizer_1 localizer_2 robot_east robot_west drivers_east drivers_west
# shellcheck disable=SC2086  # lists
compose run --rm -T --name "$monitor" tools fleetloc-monitor --run $runs --ground-truth $truths \
  --localizer /runs/localizer_1 /runs/localizer_2 2>>"$log" &
watch=$!
wait_for_drivers
stop "all robots" "$robot_containers" robot_east robot_west
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
