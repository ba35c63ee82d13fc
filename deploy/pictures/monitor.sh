#!/bin/sh
# monitor.sh DOMAIN MAP [PROGRAMS]
# Makes monitor.png of this folder: the page of fleetloc-monitor with the fleet that drives in this
# DDS domain at the moment, 20 s after two robots are localized. For that of the demo:
#   deploy/demo.sh & deploy/pictures/monitor.sh 0 out/demo/world/map/map.pcd
# Needs the packages chromium and pngquant, and the programs in PROGRAMS (build/release/bin).
set -eu

fail() {
  echo "monitor.sh: $1" >&2
  exit "${2:-1}"
}
[ $# -ge 2 ] && [ $# -le 3 ] || fail "usage: monitor.sh DOMAIN MAP [PROGRAMS]" 2
here=$(cd "$(dirname "$0")" && pwd)
monitor=${3:-$here/../../build/release/bin}/fleetloc-monitor
for tool in "$monitor" chromium pngquant; do
  command -v "$tool" >/dev/null || fail "there is no $tool" 2
done
scratch=$(mktemp -d)
page=""
end() {
  [ -z "$page" ] || kill "$page" 2>/dev/null || true
  rm -rf "$scratch"
}
trap end EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP

tries=0
until [ "$("$monitor" --domain "$1" --once | grep -c ' localized ')" -ge 2 ]; do
  tries=$((tries + 1))
  [ $tries -lt 200 ] || fail "no two robots are localized in domain $1"
done
"$monitor" --domain "$1" --http 0 --map "$2" >"$scratch/log" 2>&1 &
page=$!
sleep 20  # of way
address=$(sed -n 's/^\(http:.*\)$/\1/p;1q' "$scratch/log")
chromium --headless --no-sandbox --disable-gpu --hide-scrollbars --window-size=1280,640 \
  --timeout=8000 --screenshot="$scratch/page.png" "$address" >"$scratch/browser" 2>&1 ||
  fail "chromium: $(tail -n 1 "$scratch/browser")"
pngquant --force --strip --output "$here/monitor.png" 64 "$scratch/page.png"
echo "$here/monitor.png: $(wc -c <"$here/monitor.png") bytes"
