#!/bin/sh
# compose.sh [-n RUNS] [-s] [on|off]...        e.g. compose.sh -n 3 on off
# deploy/docker/up.sh whole, with DDS Security (on) and without (off), RUNS times each (1). Prints what
# compose_figures.py does. -s lets a stranger try to join at one site, whose traffic tcpdump keeps in
# OUT/.../east.pcap. Of a fleet with keys it has another fleet's: it must find nobody, and nobody it; of
# one without it has none, and must be served, as a control. Keys must be in no image, log or report,
# and gone at the end. Fails if a run or an expectation does, of which each names itself. Takes the
# images as they are (deploy/docker/up.sh makes them). Needs root, Docker, python3, and tcpdump for -s.
# OUT (out/compose) keeps the run folders; the volumes of the project fleetloc-compose-test stay, too.
set -eu

root=$(cd "$(dirname "$0")/../.." && pwd)
out=${OUT:-$root/out/compose}
export FLEETLOC_PROJECT=fleetloc-compose-test
project=$FLEETLOC_PROJECT
runs=1
stranger=no
while getopts n:s option; do
  case $option in
    n) runs=$OPTARG ;;
    s) stranger=yes ;;
    *) exit 2 ;;
  esac
done
shift $((OPTIND - 1))
[ $# -gt 0 ] || set -- on off
for security; do
  case $security in
    on | off) ;;
    *) echo "compose.sh: '$security' is neither on nor off" >&2; exit 2 ;;
  esac
done

fail() {
  echo "compose.sh: $1" >&2
  exit 1
}
[ "$(id -u)" = 0 ] || fail "needs root"
[ $stranger = no ] || command -v tcpdump >/dev/null || fail "needs tcpdump"
scratch=$(mktemp -d)
up='' capture=''
end() {
  trap - EXIT INT TERM HUP
  docker rm -fv "$project-stranger" >/dev/null 2>&1 || true
  # shellcheck disable=SC2086  # none, one or two
  [ -z "$up$capture" ] || kill $up $capture 2>/dev/null || true
  wait
  rm -rf "$scratch"
}
trap end EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP

# shellcheck source=test/expect.sh
. "$root/test/expect.sh"

container() {  # SERVICE: its container, while it runs
  docker ps --quiet --no-trunc --filter "label=com.docker.compose.project=$project" \
    --filter "label=com.docker.compose.service=$1"
}
until_true() {  # WHAT COMMAND...: while up.sh runs
  what=$1
  shift
  until "$@" >/dev/null 2>&1; do
    kill -0 "$up" 2>/dev/null || fail "$what: up.sh has ended: $(tail -n 2 "$here/said")"
    sleep 0.5
  done
}
is_running() { [ -n "$(container "$1")" ]; }

# Processor time of the localizers so far, each second, to a file for each.
watch_localizers() {
  while kill -0 "$up" 2>/dev/null; do
    for name in localizer_1 localizer_2; do
      id=$(container $name)
      [ -z "$id" ] || docker top "$id" -eo pid,cputimes,comm 2>/dev/null |
        awk '$3 ~ /^fleetloc-cloud/ {print $2}' >"$scratch/cpu" || true
      [ ! -s "$scratch/cpu" ] || mv "$scratch/cpu" "$here/$name.cpu_s"
    done
    sleep 1
  done
}

keys() { "$root/deploy/security/fleet-keys.sh" --dir "$scratch/other" "$@" >/dev/null; }

# A robot at the site east that plays the same recording. Its name is that of a robot of this fleet.
join() {  # on|off
  set -- "$1" --env FLEETLOC_ROBOT_ID=east_9 --env FLEETLOC_SECURITY="$1"
  if [ "$1" = on ]; then
    [ -d "$scratch/other" ] || { keys ca --fleet "$project"; keys robot east_9; }
    chown -R 10001:10001 "$scratch/other/robots"
    set -- "$@" --env FLEETLOC_QOS=/usr/share/fleetloc/robot/qos_profiles/nbiot-secure-peers.xml
  else
    mkdir -p "$scratch/other/robots/east_9"
    set -- "$@" --env FLEETLOC_QOS=/usr/share/fleetloc/robot/qos_profiles/nbiot-peers.xml
  fi
  shift
  docker run --detach --name "$project-stranger" --network "${project}_east" "$@" \
    --volume "$scratch/other/robots/east_9:/keys:ro" --volume "${project}_drives:/drives:ro" \
    fleetloc-robot --duration 30 >/dev/null
}

begin_capture() {
  until_true "network east" docker network inspect "${project}_east"
  bridge=br-$(docker network inspect --format '{{.Id}}' "${project}_east" | cut -c 1-12)
  tcpdump -i "$bridge" -n -U -w "$here/east.pcap" udp >/dev/null 2>"$here/tcpdump.log" &
  capture=$!
}

end_capture() {  # on|off
  docker wait "$project-stranger" >"$here/stranger.status"
  docker logs "$project-stranger" >"$here/stranger.log" 2>&1
  address=$(cat "$here/stranger.address")
  docker rm -fv "$project-stranger" >/dev/null
  kill "$capture" || fail "tcpdump has ended: $(tail -n 1 "$here/tcpdump.log")"
  wait "$capture" 2>/dev/null || true
  capture=''
  expect "the stranger has an address" test -n "$address"
  for direction in src dst; do
    tcpdump -n -r "$here/east.pcap" "$direction" host "$address" 2>/dev/null |
      awk '{sum += $NF} END {print NR, sum + 0}' >"$here/stranger.$direction"
    echo "stranger $direction: $(sed 's/ / datagrams, /' "$here/stranger.$direction") bytes"
  done
  # As discovery has names of topics: behind a length. Permissions have them, too, in clear text.
  LC_ALL=C grep -aoP '\x00\Kfleetloc/[0-9]+/[A-Za-z0-9_]+/[a-z_]+' "$here/east.pcap" | sort |
    uniq -c | awk '{print "in clear text:", $2, $1, "times"}' >"$here/clear"
  sort -k4 "$here/clear" | head -n 3
}

judge_stranger() {  # on|off
  expect "the stranger plays to its end" test "$(cat "$here/stranger.status")" = 0
  expect "and speaks to the fleet" test "$(cut -d' ' -f1 "$here/stranger.src")" -gt 0
  was_served() { grep -qs east_9 "$here"/localizer_1/sessions.json "$here"/localizer_2/sessions.json; }
  found() { grep -q 'east_9: localizer localizer_' "$here/stranger.log"; }
  if [ "$1" = on ]; then
    expect "a robot of another fleet finds no localizer" not found
    expect "no localizer has a session of it" not was_served
    expect "no name of a topic is in clear text" test ! -s "$here/clear"
  else
    expect "without keys it finds one" found
    expect "and is served" was_served
    expect "names of topics are in clear text" test -s "$here/clear"
  fi
}

look_for_keys() {
  expect "no private key in logs, folders and report" not grep -rqa "PRIVATE KEY" "$here"
  for part in robot cloud tools; do
    found=$(docker run --rm --network none --user 0 --entrypoint sh "fleetloc-$part" -c \
      'grep -rlas "BEGIN.*PRIVATE KEY" /etc /usr/local /usr/share /runs /home /root /opt /tmp; true')
    expect "no key in the image fleetloc-$part, but: $found" test -z "$found"
  done
  expect "the keys are gone" test -z "$(ls "$scratch/tmp")"
}

run() {  # on|off NUMBER
  here=$out/security-$1-$2
  rm -rf "$here"
  mkdir -p "$here" "$scratch/tmp"
  switch=''
  [ "$1" = on ] || switch=--insecure
  # shellcheck disable=SC2086  # none or one
  TMPDIR=$scratch/tmp "$root/deploy/docker/up.sh" --no-build $switch --out "$here" >"$here/said" 2>&1 &
  up=$!
  if [ $stranger = yes ]; then
    begin_capture
    until_true "robots" is_running robot_east_1
    rm -rf "$scratch/other"
    join "$1"
    docker inspect --format '{{range .NetworkSettings.Networks}}{{.IPAddress}}{{end}}' \
      "$project-stranger" >"$here/stranger.address"
    end_capture "$1"
  fi
  watch_localizers
  wait $up || fail "up.sh $switch: $(tail -n 3 "$here/said")"
  up=''
  python3 "$root/test/fleet/compose_figures.py" "$1" "$2" "$here"
  [ $stranger = no ] || judge_stranger "$1"
  look_for_keys
}

python3 "$root/test/fleet/compose_figures.py"
for security in "$@"; do
  number=0
  while [ $number -lt "$runs" ]; do
    number=$((number + 1))
    run "$security" $number
  done
done
[ "$failures" = 0 ] || exit 1
echo "compose: all as expected"
