#!/bin/sh
# compare_builds.sh OLD_BUILD NEW_BUILD [OUT]     e.g. compare_builds.sh ../before/build/release build/release
# Whether two builds (folders with bin/) compute the same, for changes that are to change nothing.
# Both simulate a drive (tracks, images, lidar), make maps and replay what follows; then it compares
# by bytes: the simulation, the maps, the .tum files, diagnostics.csv and answers.csv; summary.json
# and sessions.json without processor times and memory. OUT (default: a temporary folder) keeps the
# runs; those of the OLD_BUILD that are there are not made again.
#   loop            a drive by its tracks, with the map
#   lossy, paper    the same over a poor link; in paper mode
#   icp             the same with the baseline
#   images          odometry of rendered images
#   semireal_v101, MH_01  recordings, if they lie beside the checkout (RECORDINGS=DIR); else it says so
# Exit 0: the same. 1: something differs; each such file is named. 2: cannot start.
set -eu

fail() {
  echo "compare_builds.sh: $1" >&2
  exit 2
}

[ $# -ge 2 ] && [ $# -le 3 ] || fail "usage: compare_builds.sh OLD_BUILD NEW_BUILD [OUT]"
for build in "$1" "$2"; do
  [ -x "$build/bin/fleetloc-replay" ] || fail "there is no $build/bin/fleetloc-replay"
done
old=$(cd "$1" && pwd)
new=$(cd "$2" && pwd)
if [ $# = 3 ]; then
  mkdir -p "$3"
  out=$(cd "$3" && pwd)
else
  out=$(mktemp -d)
  trap 'rm -rf "$out"' EXIT
fi
recordings=${RECORDINGS:-$(cd "$(dirname "$0")/../.." && pwd)/shared/data}
differing=0

# A build reads the worlds of its own sources: their keys may have other names by now.
sources_of() {
  sed -n 's/^CMAKE_HOME_DIRECTORY:INTERNAL=//p' "$1/CMakeCache.txt"
}

# must FOLDER COMMAND...: runs it, unless an earlier call has.
must() {
  done_file=$1/.done
  shift
  [ ! -e "$done_file" ] || return 0
  "$@" >"$out/last.log" 2>&1 || {
    cat "$out/last.log" >&2
    fail "failed: $*"
  }
  touch "$done_file"
}

# make_world BUILD TO: a loop of tracks with its survey, and two seconds of images.
make_world() {
  worlds=$(sources_of "$1")/deploy/worlds
  simulate="$1/bin/fleetloc-sim --scene $worlds/campus.yaml --route $worlds/quad.yaml"
  mkdir -p "$2/survey" "$2/drive" "$2/images" "$2/map"
  must "$2/survey" $simulate --no-images --lidar --out "$2/survey"
  must "$2/drive" $simulate --seed 2 --tracks --out "$2/drive"
  must "$2/images" $simulate --seed 3 --duration 4 --out "$2/images"
  must "$2/map" "$1/bin/fleetloc-map" build \
    --cloud "$2/survey/mav0/pointcloud0/data.ply" --out "$2/map/map.pcd"
}

# The ground truth's pose at the first image of DATASET, 0.3 m beside, for --initial-pose.
start_pose() {
  frames=$1/mav0/tracks0/data.csv
  [ -e "$frames" ] || frames=$1/mav0/cam0/data.csv
  first=$(grep -v '^#' "$frames" | head -n 1 | cut -d , -f 1)
  awk -F , -v first="$first" '!/^#/ && $1 >= first {
    print $2 + 0.2, $3 + 0.2, $4 + 0.1, $6, $7, $8, $5; exit
  }' "$1/mav0/state_groundtruth_estimate0/data.csv"
}

# What a run computed, as text that may be compared by bytes.
without_times() {
  awk '
    # p50 and p99 of a time stand in braces, on lines of their own or not.
    /"(wall_s|cpu_s|cpu_ms_per_frame|fusion_us_per_imu|max_rss_bytes|memory_bytes)"/ { next }
    /"(decode_ms|tracking_ms|backend_ms|optimize_ms)"/ { inside = !/}/; next }
    inside { inside = !/}/; next }
    { print }' "$1"
}

same() {
  if ! cmp -s "$1" "$2"; then
    differing=$((differing + 1))
    echo "DIFFERS: $2"
  fi
}

compare_worlds() {
  (cd "$1" && find . -type f ! -name .done ! -name '*.yaml' | sort) >"$out/files"
  while read -r file; do
    if [ ! -e "$2/$file" ]; then
      differing=$((differing + 1))
      echo "MISSING: $2/$file"
    else
      same "$1/$file" "$2/$file"
    fi
  done <"$out/files"
  echo "world: $(wc -l <"$out/files") files compared"
}

# replay BUILD TO NAME [OPTION...]: with the configuration NAME.yaml of the build, if it has one.
replay() {
  replaying=$1
  to=$2
  config=$(sources_of "$1")/deploy/config/$3.yaml
  shift 3
  [ ! -e "$config" ] || set -- "$@" --config "$config"
  mkdir -p "$to"
  must "$to" "$replaying/bin/fleetloc-replay" --out "$to" "$@"
}

# compare_run NAME [OPTION...]: of fleetloc-replay.
compare_run() {
  name=$1
  shift
  replay "$old" "$out/old/$name" "$name" "$@"
  replay "$new" "$out/new/$name" "$name" "$@"
  for file in odometry.tum localization.tum localization_frames.tum diagnostics.csv answers.csv; do
    same "$out/old/$name/$file" "$out/new/$name/$file"
  done
  for file in summary.json sessions.json; do
    [ -e "$out/old/$name/$file" ] || continue
    without_times "$out/old/$name/$file" >"$out/old/$name/$file.timeless"
    without_times "$out/new/$name/$file" >"$out/new/$name/$file.timeless"
    same "$out/old/$name/$file.timeless" "$out/new/$name/$file.timeless"
  done
  echo "$name: $(grep -c . "$out/new/$name/localization_frames.tum") localized frames," \
    "$(($(grep -c . "$out/new/$name/answers.csv") - 1)) answers"
}

# compare_recording NAME FOLDER: with a map if it has a scan.
compare_recording() {
  if [ ! -d "$2" ]; then
    echo "$1: skipped, there is no $2"
    return
  fi
  scan=$2/mav0/pointcloud0/data.ply
  if [ -e "$scan" ]; then
    mkdir -p "$out/old/map_$1"
    must "$out/old/map_$1" "$old/bin/fleetloc-map" build --cloud "$scan" --out "$out/old/map_$1/map.pcd"
    compare_run "$1" --dataset "$2" --map "$out/old/map_$1/map.pcd" --initial-pose "$(start_pose "$2")"
  else
    compare_run "$1" --dataset "$2"
  fi
}

make_world "$old" "$out/old/world"
rm -rf "$out/new"
make_world "$new" "$out/new/world"
compare_worlds "$out/old/world" "$out/new/world"

world=$out/old/world
drive="--dataset $world/drive --tracks --map $world/map/map.pcd"
pose=$(start_pose "$world/drive")
link="--loss 0.05 --latency 0.3 --bandwidth 62500 --seed 7"
# shellcheck disable=SC2086  # words on purpose
compare_run loop $drive --initial-pose "$pose"
# shellcheck disable=SC2086
compare_run lossy $drive --initial-pose "$pose" $link
# shellcheck disable=SC2086
compare_run paper $drive --initial-pose "$pose" --duration 40
# shellcheck disable=SC2086
compare_run icp $drive --initial-pose "$pose" --duration 40 --baseline icp
compare_run images --dataset "$world/images"
compare_recording semireal_v101 "$recordings/semireal_v101"
compare_recording MH_01 "$recordings/euroc_mh01_17s"

if [ "$differing" -gt 0 ]; then
  echo "compare_builds.sh: $differing files differ"
  exit 1
fi
echo "compare_builds.sh: the builds compute the same"
