#!/usr/bin/env bash
# Localizes a recorded flight in its laser map: map, localizer and robot as separate processes over
# DDS, then the errors of odometry alone and of the localized pose.
set -euo pipefail

usage() {
  cat <<'TEXT'
usage: deploy/demo.sh DATASET [--out DIR] [--rate R] [--initial-pose "x y z qx qy qz qw"]

DATASET is a folder in the EuRoC/ASL layout with a laser map and ground truth:
  mav0/{cam0,cam1,imu0}/           images, IMU and their sensor.yaml
  mav0/pointcloud0/data.ply        the laser map (EuRoC's Vicon room sequences have one)
  mav0/state_groundtruth_estimate0/data.csv
--rate R          speed of the recording; 1 is real time (default)
--initial-pose P  pose of the body in the map at the first image. Without it: the ground truth
                  there, displaced by 0.3 m and 3 degrees of yaw
--out DIR         default: out/demo
Installs what is missing (see deploy/install-deps.sh), builds, and writes run folders to DIR.
TEXT
}

fail() { echo "demo: $*" >&2; exit "${2:-1}"; }

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
dataset= out=$root/out/demo rate=1 initial_pose=
while [ $# -gt 0 ]; do
  case $1 in
    -h|--help) usage; exit 0 ;;
    --out|--rate|--initial-pose)
      [ $# -ge 2 ] || { echo "demo: $1 needs a value" >&2; exit 2; }
      case $1 in --out) out=$2 ;; --rate) rate=$2 ;; *) initial_pose=$2 ;; esac
      shift 2 ;;
    -*) echo "demo: unknown option $1 (see --help)" >&2; exit 2 ;;
    *) [ -z "$dataset" ] || { echo "demo: one dataset at a time" >&2; exit 2; }
       dataset=$1; shift ;;
  esac
done
if [ -z "$dataset" ]; then
  usage >&2
  exit 2
fi
[ -d "$dataset/mav0" ] || { echo "demo: $dataset/mav0: no such folder" >&2; exit 2; }
dataset=$(cd "$dataset" && pwd)
cloud=$dataset/mav0/pointcloud0/data.ply
truth=$dataset/mav0/state_groundtruth_estimate0/data.csv
[ -f "$cloud" ] || { echo "demo: $cloud: no such file" >&2; exit 2; }
[ -f "$truth" ] || { echo "demo: $truth: no such file" >&2; exit 2; }
mkdir -p "$out" && out=$(cd "$out" && pwd)

sh "$root/deploy/install-deps.sh" || exit $?
sh "$root/deploy/build.sh" release fleetloc-map fleetloc-cloud fleetloc-robot fleetloc-eval
bin=$root/build/release/bin

children=()
cleanup() {
  for child in "${children[@]}"; do kill -TERM "$child" 2>/dev/null || true; done
  for child in "${children[@]}"; do wait "$child" 2>/dev/null || true; done
}
trap cleanup EXIT
trap 'exit 130' INT TERM

echo "== map"
"$bin/fleetloc-map" build --cloud "$cloud" --out "$out/map.pcd"

if [ -z "$initial_pose" ]; then
  first=$(sed -n 2p "$dataset/mav0/cam0/data.csv"); first=${first%%,*}
  initial_pose=$("$bin/fleetloc-eval" --ground-truth "$truth" --pose-at-ns "$first" \
    --displaced "0.2 0.2 0.1 3")
fi

echo "== localizer and robot, DDS domain ${FLEETLOC_DOMAIN:-0}, rate $rate"
"$bin/fleetloc-cloud" --map "$out/map.pcd" --name localizer_1 --qos "$root/qos_profiles/lan.xml" \
  --domain "${FLEETLOC_DOMAIN:-0}" --out "$out/localizer_1" > "$out/localizer_1.log" 2>&1 &
localizer=$!
children+=("$localizer")
for _ in $(seq 200); do  # until the map is loaded
  grep -q serving "$out/localizer_1.log" && break
  kill -0 "$localizer" 2>/dev/null || break
  sleep 0.1
done
grep serving "$out/localizer_1.log" || { cat "$out/localizer_1.log" >&2; fail "no localizer"; }
"$bin/fleetloc-robot" --robot-id robot_1 --dataset "$dataset" --qos "$root/qos_profiles/lan.xml" \
  --domain "${FLEETLOC_DOMAIN:-0}" --rate "$rate" --initial-pose "$initial_pose" \
  --out "$out/robot_1" &
robot=$!
children+=("$robot")
wait "$robot" || fail "the robot failed (exit code $?)"
kill -0 "$localizer" 2>/dev/null || { cat "$out/localizer_1.log" >&2; fail "the localizer died"; }
cleanup
children=()

echo "== errors"
"$bin/fleetloc-eval" --run "$out/robot_1" --ground-truth "$truth"
echo "run folders: $out/robot_1, $out/localizer_1"
