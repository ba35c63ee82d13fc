#!/bin/sh
# make.sh [PROGRAMS]
# Makes the pictures of this folder from nothing, with the programs in PROGRAMS (build/release/bin):
#   seasons.png       four places of a made-up campus in each season, and a lidar scan
#   trajectories.png  a replay of a drive in autumn over the map of a survey in summer, coloured by
#                     error: localized, and aligned once at the start
# Needs the packages gnuplot-nox, librsvg2-bin and pngquant. Takes some minutes.
set -eu

fail() {
  echo "make.sh: $1" >&2
  exit "${2:-1}"
}
here=$(cd "$(dirname "$0")" && pwd)
worlds=$here/../worlds
programs=${1:-$here/../../build/release/bin}
[ $# -le 1 ] || fail "usage: make.sh [PROGRAMS]" 2
for tool in "$programs/fleetloc-sim" "$programs/fleetloc-map" "$programs/fleetloc-replay" \
  "$programs/fleetloc-eval" gnuplot rsvg-convert pngquant; do
  command -v "$tool" >/dev/null || fail "there is no $tool" 2
done
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP
cd "$scratch"

# A picture of WIDTH pixels, of few colours, out of an SVG.
convert() {  # SVG WIDTH COLOURS PNG
  rsvg-convert --background-color white --width "$2" --keep-aspect-ratio --output big.png "$1"
  pngquant --force --strip --output "$4" "$3" big.png
}

echo "== seasons"
"$programs/fleetloc-sim" --scene "$worlds/campus.yaml" --route "$worlds/quad.yaml" \
  --contact-sheet sheet.png >/dev/null
# Width and height of a PNG stand at its byte 16.
# shellcheck disable=SC2046  # eight words
set -- $(od -A n -t u1 -j 16 -N 8 sheet.png)
width=$((($3 << 8) + $4)) height=$((($7 << 8) + $8))
cat >sheet.svg <<SVG
<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"
  width="$width" height="$height"><image xlink:href="sheet.png" width="$width" height="$height"/></svg>
SVG
convert sheet.svg 900 28 "$here/seasons.png"

echo "== trajectories: survey and map"
echo 'sim: {images: {rate_hz: 10}}' >sim.yaml
simulate() {
  "$programs/fleetloc-sim" --config sim.yaml --scene "$worlds/campus.yaml" \
    --route "$worlds/loop.yaml" "$@" >/dev/null
}
simulate --no-images --lidar --no-merged-cloud --out survey
"$programs/fleetloc-map" build --dataset survey --out map.pcd >/dev/null
echo "== trajectories: drive and replay"
simulate --season autumn --seed 2 --tracks --out drive
truth=drive/mav0/state_groundtruth_estimate0/data.csv
first=$(sed -n 2p drive/mav0/tracks0/data.csv)
start=$("$programs/fleetloc-eval" --ground-truth $truth --pose-at-ns "${first%%,*}" \
  --displaced "0.2 0.2 0.1 3")
"$programs/fleetloc-replay" --dataset drive --tracks --map map.pcd --initial-pose "$start" \
  --out run >/dev/null
"$programs/fleetloc-eval" --run run --ground-truth $truth --map map.pcd --report report.html

# The figure of the report with that title, below a heading and at its place in a row.
figure() {  # TITLE X HEADING
  place="x=\"$2\" y=\"24\" width=\"$width\" height=\"$height\" overflow=\"visible\""
  awk -v title="aria-label=\"$1\"" -v place="$place" '
    index($0, title) { inside = 1; sub("<svg", "<svg " place) }
    inside { print }
    inside && index($0, "</svg>") { exit }' report.html
  echo "<text x=\"$(($2 + 58))\" y=\"18\" font-family=\"sans-serif\" font-size=\"16\">$3</text>"
}
# shellcheck disable=SC2046  # two words
set -- $(grep -A 3 'aria-label="localized, from above"' report.html |
  sed -n 's/.*viewBox="0 0 \([0-9]*\) \([0-9]*\)".*/\1 \2/p' | head -n 1)
width=$1 height=$2
{
  echo "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"-12 0 $((2 * width + 12)) $((height + 24))\">"
  figure "localized, from above" 0 "localized"
  figure "aligned once, from above" "$width" "aligned once at the start, then odometry"
  echo '</svg>'
} >pair.svg
convert pair.svg 900 64 "$here/trajectories.png"
ls -l "$here"/*.png
