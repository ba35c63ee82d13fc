#!/bin/sh
# endurance.sh [FRAMES]   a robot runs FRAMES frames (200000) at full speed: does its memory stay flat?
# Builds test/endurance first. With 200000 five minutes, and then twenty with a localizer in the same
# process. Exit 0: memory as after the first tenth, within 2 %.
set -eu

case ${1:-200000} in
  *[!0-9]* | "") echo "usage: test/endurance.sh [FRAMES]" >&2; exit 2 ;;
esac
root=$(cd "$(dirname "$0")/.." && pwd)
sh "$root/deploy/build.sh" release endurance_tests
FLEETLOC_ENDURANCE_FRAMES=${1:-200000} exec "$root/build/release/bin/endurance_tests"
