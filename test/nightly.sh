#!/bin/sh
# test/nightly.sh [PART...]      what takes too long for test/run.sh, each part whole: all, or those named
#   demo       deploy/demo.sh; both robots covered, never wrong and sure                       5 min
#   packages   deploy/package.sh; installed, run by systemd, upgraded, removed                10 min
#   compose    deploy/docker/up.sh with keys and without, and a stranger who tries to join    10 min
#   lines      robots with keys meet localizers over 4 KB/s, and where 30 % is lost            7 min
#   soak       a fleet in containers with faults at random                                    35 min
#   endurance  a robot over 200,000 frames, and with a localizer                              30 min
#   fuzz       a minute for each decoder                                                      60 min
# The minutes are for two cores, after the build. A part that fails does not keep the next ones from
# running; ends with a table, and with 1 if one failed. Logs and runs are in OUT (out/nightly). Needs root;
# packages, compose and soak need Docker.
set -eu

cd "$(dirname "$0")/.."
out=${OUT:-$PWD/out/nightly}
parts="demo packages compose lines soak endurance fuzz"

demo() {
  deploy/demo.sh --out "$out/demo" || return
  test/judge_runs.py 0.6 "$out/demo/robot_1" "$out/demo/robot_2"
}
packages() {
  sh deploy/package.sh || return
  base_image || return
  test/fleet/packages.sh
}
compose() {
  base_image || return
  deploy/docker/up.sh --packages --out "$out/up" || return
  OUT=$out/compose test/fleet/compose.sh -s on off
}
lines() {
  sh deploy/build.sh release fleet_robot || return
  LIMIT=60 test/fleet/narrow_line.sh -k "nbiot-peers nbiot-secure-peers" 3 || return
  LIMIT=60 test/fleet/security.sh -k "wifi wifi-secure" 0 30
}
soak() { test/fleet/soak.sh --minutes 30 --out "$out/soak"; }
endurance() { test/endurance.sh; }
fuzz() { test/fuzz.sh; }

# Sites without a registry make it of Debian's packages.
base_image() {
  base=${FLEETLOC_BASE:-debian:bookworm-slim}
  docker image inspect "$base" >/dev/null 2>&1 || docker pull "$base" || deploy/docker/base-image.sh
}

case " $parts " in
  *" ${1:-demo} "*) ;;
  *) sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' test/nightly.sh >&2; exit 2 ;;
esac
if [ "${FLEETLOC_NIGHTLY_PART:-}" ]; then
  "$1"
  exit
fi

# shellcheck disable=SC2086  # words
[ $# -gt 0 ] || set -- $parts
for part; do
  case " $parts " in
    *" $part "*) ;;
    *) echo "test/nightly.sh: no part '$part'; there are: $parts" >&2; exit 2 ;;
  esac
done
mkdir -p "$out"
scratch=$(mktemp -d)
# shellcheck source=test/children.sh
. test/children.sh

failed=0
for part; do
  begun=$(date +%s)
  echo "test/nightly.sh: $part: see $out/$part.log"
  outcome=passed
  run env FLEETLOC_NIGHTLY_PART=yes OUT="$out" sh test/nightly.sh "$part" >"$out/$part.log" 2>&1 || outcome=FAILED
  [ $outcome = passed ] || failed=$((failed + 1))
  printf '%-10s %s %5s s\n' "$part" $outcome $(($(date +%s) - begun)) | tee -a "$scratch/table"
done
echo
cat "$scratch/table"
[ $failed -eq 0 ]
