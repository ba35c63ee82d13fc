#!/bin/sh
# record.sh FOLDER [BUILD]      e.g. record.sh out/training build/release
# Simulates the drives that idl/compact_models.txt is trained on, and those that it is judged by, and
# records what their robots send and get: FOLDER/training/*.samples, FOLDER/unseen/*.samples, each
# drive with a good link and one that loses 70 % of the datagrams. Drives that are there are kept;
# the samples are those of the BUILD, and are recorded anew.
# The recording semireal_v101 is among the unseen ones if it lies beside the checkout
# (RECORDINGS=DIR). 25 minutes of processor time.
set -eu

[ $# -ge 1 ] && [ $# -le 2 ] || { echo "usage: record.sh FOLDER [BUILD]" >&2; exit 2; }
root=$(cd "$(dirname "$0")/../.." && pwd)
programs=$(cd "${2:-$root/build/release}/bin" && pwd)
mkdir -p "$1/drives" "$1/training" "$1/unseen"
folder=$(cd "$1" && pwd)
worlds=$root/deploy/worlds
recordings=${RECORDINGS:-$root/../shared/data}
echo "sim: {images: {rate_hz: 10}}" >"$folder/ten_hertz.yaml"

# must RESULT PROGRAM ARGUMENT...: makes RESULT, unless it is there.
must() {
  result=$1
  program=$2
  shift 2
  [ ! -e "$result" ] || return 0
  echo "record.sh: $(basename "$result")"
  "$programs/$program" "$@" >"$folder/last.log" 2>&1 || {
    cat "$folder/last.log" >&2
    rm -rf "$result"
    exit 1
  }
}

# map NAME ROUTE SCENE_SEED: of a survey in summer.
map() {
  [ ! -e "$folder/$1.pcd" ] || return 0
  must "$folder/drives/$1_survey" fleetloc-sim --scene "$worlds/campus.yaml" \
    --route "$worlds/$2" --scene-seed "$3" --no-images --lidar --no-merged-cloud \
    --out "$folder/drives/$1_survey"
  must "$folder/$1.pcd" fleetloc-map build --dataset "$folder/drives/$1_survey" \
    --out "$folder/$1.pcd"
  rm -r "$folder/drives/$1_survey"
}

# drive NAME ROUTE SCENE_SEED SEASON SEED OPTION...
drive() {
  name=$1
  route=$2
  scene_seed=$3
  season=$4
  seed=$5
  shift 5
  must "$folder/drives/$name" fleetloc-sim --scene "$worlds/campus.yaml" \
    --route "$worlds/$route" --scene-seed "$scene_seed" --season "$season" --seed "$seed" \
    --config "$folder/ten_hertz.yaml" --out "$folder/drives/$name" "$@"
}

# record SET NAME MAP [DATASET GROUND_TRUTH]: two replays.
record() {
  dataset=${4:-$folder/drives/$2}
  truth=${5:-$dataset/mav0/state_groundtruth_estimate0/data.csv}
  frames=$dataset/mav0/tracks0/data.csv
  tracks=--tracks
  if [ ! -e "$frames" ]; then
    frames=$dataset/mav0/cam0/data.csv
    tracks=
  fi
  first=$(grep -v '^#' "$frames" | head -n 1 | cut -d , -f 1)
  start=$("$programs/fleetloc-eval" --ground-truth "$truth" --pose-at-ns "$first" \
    --displaced "0.2 0.2 0.1 3")
  for loss in 0 0.7; do
    run=$folder/runs/$2_loss_$loss
    rm -rf "$run" "$folder/$1/$2_loss_$loss.samples"
    must "$run" fleetloc-replay --dataset "$dataset" $tracks --map "$3" \
      --initial-pose "$start" --loss $loss --out "$run" \
      --samples "$folder/$1/$2_loss_$loss.samples"
  done
}

# A room, by images.
must "$folder/room.ply" room_files "$folder/room.ply" "$folder/room.tum"
must "$folder/room.pcd" fleetloc-map build --cloud "$folder/room.ply" --out "$folder/room.pcd"
must "$folder/drives/room" fleetloc-sim --cloud "$folder/room.ply" \
  --trajectory "$folder/room.tum" --config "$folder/ten_hertz.yaml" --duration 44 \
  --out "$folder/drives/room"

# Streets, by tracks and by images.
map street quad.yaml 2
drive street_autumn quad.yaml 2 autumn 21 --tracks
drive street_winter quad.yaml 2 winter 22 --tracks
drive street_images quad.yaml 2 autumn 23 --duration 40
map road ring-reversed.yaml 3
drive road_spring ring-reversed.yaml 3 spring 23 --tracks
# Another world, to judge by.
map ring ring.yaml 1
drive ring_autumn ring.yaml 1 autumn 11 --tracks
drive ring_winter ring.yaml 1 winter 13 --tracks

for name in street_autumn street_winter street_images; do
  record training $name "$folder/street.pcd"
done
record training road_spring "$folder/road.pcd"
record training room "$folder/room.pcd"
for name in ring_autumn ring_winter; do record unseen $name "$folder/ring.pcd"; done
if [ -d "$recordings/semireal_v101" ]; then
  must "$folder/v101.pcd" fleetloc-map build \
    --cloud "$recordings/semireal_v101/mav0/pointcloud0/data.ply" --out "$folder/v101.pcd"
  record unseen semireal_v101 "$folder/v101.pcd" "$recordings/semireal_v101" \
    "$recordings/semireal_v101/mav0/state_groundtruth_estimate0/data.csv"
else
  echo "record.sh: without semireal_v101: it is not in $recordings"
fi
