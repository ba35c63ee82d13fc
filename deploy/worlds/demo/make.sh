#!/bin/sh
# make.sh map|drives FOLDER [PROGRAMS]
# Makes in FOLDER what the demo runs on, unless it is there, made of the same inputs by the same
# programs (which are in the folder PROGRAMS, or found by $PATH):
#   map     survey/ (with lidar, in summer), map/map.pcd
#   drives  drives/robot_*/ (in autumn) and drives/robot_*.start, the pose that a robot is told to
#           start from; truth/robot_*.csv, set apart: the programs under test never see it
set -eu

fail() {
  echo "make.sh: $1" >&2
  exit "${2:-1}"
}
[ $# -ge 2 ] || fail "usage: make.sh map|drives FOLDER [PROGRAMS]" 2
mkdir -p "$2"
folder=$(cd "$2" && pwd)
programs=${3:-}
[ -z "$programs" ] || programs=$(cd "$programs" && pwd)/
cd "$(dirname "$0")"

# Runs a command that makes RESULT, unless it is there, made of the same inputs by the same command.
made() {  # RESULT INPUTS COMMAND...
  result=$1
  hash=$({ echo "$2 $*"; sha256sum "$(command -v "$3")"; } | sha256sum)
  shift 2
  if [ -e "$result" ] && [ "$(cat "$result.inputs" 2>/dev/null)" = "$hash" ]; then
    echo "   $(basename "$result"): unchanged, kept"
    return
  fi
  rm -rf "$result" "$result.inputs"
  mkdir -p "$(dirname "$result")"
  "$@" >"$result.log" || fail "$(basename "$1") did not make $result"
  echo "$hash" >"$result.inputs"
}

simulated() {  # RESULT ROUTE OPTION...
  simulation=$1
  inputs=$(cat sim.yaml ../campus.yaml streets.yaml "$2" | sha256sum)
  shift
  made "$simulation" "$inputs" "${programs}fleetloc-sim" --config sim.yaml --scene ../campus.yaml \
    --out "$simulation" --route "$@"
}

case $1 in
  map)
    simulated "$folder/survey" streets.yaml --no-images --lidar --no-merged-cloud
    made "$folder/map/map.pcd" "$(cat "$folder/survey.inputs")" \
      "${programs}fleetloc-map" build --dataset "$folder/survey" --out "$folder/map/map.pcd"
    ;;
  drives)
    seed=11
    mkdir -p "$folder/truth"
    for route in robot_*.yaml; do
      drive=$folder/drives/${route%.yaml}
      truth=$folder/truth/${route%.yaml}.csv
      simulated "$drive" "$route" --built-along streets.yaml --season autumn --seed $seed
      if [ -d "$drive/mav0/state_groundtruth_estimate0" ]; then
        mv "$drive/mav0/state_groundtruth_estimate0/data.csv" "$truth"
        rm -r "$drive/mav0/state_groundtruth_estimate0"
      fi
      first=$(sed -n 2p "$drive/mav0/cam0/data.csv")
      "${programs}fleetloc-eval" --ground-truth "$truth" --pose-at-ns "${first%%,*}" \
        --displaced "0.2 0.2 0.1 3" >"$drive.start"
      seed=$((seed + 1))
    done
    ;;
  *) fail "usage: make.sh map|drives FOLDER [PROGRAMS]" 2 ;;
esac
