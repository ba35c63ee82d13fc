#!/usr/bin/env bash
# Two robots of a made-up world, or one of a recorded flight, localized in a laser map over DDS.
set -euo pipefail

usage() {
  cat <<'TEXT'
usage: deploy/demo.sh [--out DIR] [--rate R]
       deploy/demo.sh DATASET [--out DIR] [--rate R] [--initial-pose "x y z qx qy qz qw"]

Without DATASET: makes a world, surveys it with a lidar in summer and makes the map, then drives two
robots through it in autumn, each with its poor link to two localizers, all of them processes of
their own, and writes DIR/report.html. World and map are kept for the next time. The robots are live:
fleetloc-play stands in for their cameras and IMUs, over topics of ROS 2 on this computer. robot_1 is
told where it starts, robot_2 has to find itself in the map.

DATASET is a folder in the EuRoC/ASL layout with a laser map and ground truth:
  mav0/{cam0,cam1,imu0}/           images, IMU and their sensor.yaml
  mav0/pointcloud0/data.ply        the laser map (EuRoC's Vicon room sequences have one)
  mav0/state_groundtruth_estimate0/data.csv
One localizer and one robot localize it, without an emulated link.

--rate R          speed of the recordings; 1 is real time (default)
--initial-pose P  pose of the body in the map at the first image. Without it: the ground truth
                  there, displaced by 0.3 m and 3 degrees of yaw
--out DIR         default: out/demo
Installs what is missing (see deploy/install-deps.sh) and builds first. FLEETLOC_DOMAIN is the DDS
domain (0); the sensors of each robot have one of those behind it.
TEXT
}

fail() {
  end "${!name_of[@]}"  # so that theirs are not the last words
  echo "demo: $*" >&2
  exit 1
}
refuse() { echo "demo: $*" >&2; exit 2; }

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
bin=$root/build/release/bin
domain=${FLEETLOC_DOMAIN:-0}
dataset='' out=$root/out/demo rate=1 initial_pose=''
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage; exit 0 ;;
    --out | --rate | --initial-pose)
      [ $# -ge 2 ] || refuse "$1 needs a value"
      case $1 in --out) out=$2 ;; --rate) rate=$2 ;; *) initial_pose=$2 ;; esac
      shift 2 ;;
    -*) refuse "unknown option $1 (see --help)" ;;
    '') refuse "DATASET is empty (see --help)" ;;
    *) [ -z "$dataset" ] || refuse "one dataset at a time"
       dataset=$1; shift ;;
  esac
done
[[ $rate =~ ^[0-9]+(\.[0-9]+)?$ && $rate =~ [1-9] ]] || refuse "--rate: '$rate' is not a number above 0"
truth_in=mav0/state_groundtruth_estimate0/data.csv
if [ -n "$dataset" ]; then
  [ -d "$dataset/mav0" ] || refuse "$dataset/mav0: no such folder"
  dataset=$(cd "$dataset" && pwd)
  for file in mav0/pointcloud0/data.ply "$truth_in"; do
    [ -f "$dataset/$file" ] || refuse "$dataset/$file: no such file"
  done
elif [ -n "$initial_pose" ]; then
  refuse "--initial-pose is for a DATASET"
fi
mkdir -p "$out" 2>/dev/null || refuse "$out: cannot be made"
out=$(cd "$out" && pwd)
exec 9>"$out/.lock"
flock -n 9 || refuse "$out: another demo is running there"

# However this script ends, so does what it has started: each child leads a process group.
declare -A name_of=()
start() {  # NAME COMMAND...
  setsid setpriv --pdeathsig TERM "${@:2}" </dev/null 9>&- &
  child=$!
  name_of[$child]=$1
}
end() {  # CHILD...
  local child
  for child in "$@"; do kill -TERM "-$child" 2>/dev/null || kill -TERM "$child" 2>/dev/null || true; done
  for child in "$@"; do wait "$child" 2>/dev/null || true; unset "name_of[$child]"; done
}
scratch=$(mktemp -d)
cleanup() {
  trap - EXIT INT TERM HUP
  end "${!name_of[@]}"
  rm -rf "$scratch"
}
trap cleanup EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP

# Runs a command to its end, but so that signals are handled at once.
run() {
  local status=0 this
  start "$(basename "$1")" "$@"
  this=$child
  wait "$this" || status=$?
  unset "name_of[$this]"
  return $status
}

# Wall and processor time of each stage.
now() { date +%s.%N; }
stages=()
count_cpu() {  # of all children that have ended; times() would not know them in a subshell
  times >"$scratch/times"
  cpu=$(awk -F'[ms ]+' 'NR == 2 {printf "%.2f", 60 * $1 + $2 + 60 * $3 + $4}' "$scratch/times")
}
begin() {  # STAGE [MORE]
  stage=$1 stage_begin=$(now)
  count_cpu
  stage_cpu=$cpu
  echo "== $stage${2:+: $2}"
}
finish() {
  local wall
  wall=$(awk -v a="$(now)" -v b="$stage_begin" 'BEGIN {printf "%.1f", a - b}')
  count_cpu
  cpu=$(awk -v a="$cpu" -v b="$stage_cpu" 'BEGIN {printf "%.1f", a - b}')
  echo "   $wall s, $cpu s of processor time"
  stages+=("{\"name\": \"$stage\", \"wall_s\": $wall, \"cpu_s\": $cpu}")
}

start_pose() {  # DATASET TRUTH
  local first
  first=$(sed -n 2p "$1/mav0/cam0/data.csv")
  "$bin/fleetloc-eval" --ground-truth "$2" --pose-at-ns "${first%%,*}" --displaced "0.2 0.2 0.1 3"
}

# Starts localizers and waits until they serve.
localizers=()
start_localizers() {  # MAP QOS NAME...
  local map=$1 qos=$2 name log
  shift 2
  for name in "$@"; do
    rm -rf "${out:?}/$name"
    start "$name" "$bin/fleetloc-cloud" --map "$map" --name "$name" --qos "$qos" \
      --domain "$domain" --out "$out/$name" >"$out/$name.log" 2>&1
    localizers+=("$child")
  done
  for child in "${localizers[@]}"; do
    log=$out/${name_of[$child]}.log
    until grep -q serving "$log"; do
      kill -0 "$child" 2>/dev/null || fail "$(tail -n 1 "$log")"
      sleep 0.1
    done
  done
}

# The sensors of a robot as topics of ROS 2, in a domain of its own.
write_sensors() {  # NAME DATASET NUMBER
  local line folder="'${2//\'/\'\'}'"  # for YAML
  while IFS= read -r line; do
    case $line in
      domain:*) echo "domain: $(((domain + $3) % 101))" ;;
      *) echo "${line//DATASET/"$folder"}" ;;
    esac
  done <"$root/deploy/config/sensors-play.yaml" >"$out/$1.sensors.yaml"
}
robots=() drivers=()
start_robot() {  # NAME DATASET QOS [OPTION...]
  rm -rf "${out:?}/$1"
  write_sensors "$1" "$2" $((${#robots[@]} + 1))
  start "$1" "$bin/fleetloc-robot" --robot-id "$1" --sensors "$out/$1.sensors.yaml" --qos "$3" \
    --domain "$domain" --out "$out/$1" "${@:4}" >"$out/$1.log" 2>&1
  robots+=("$child")
}
start_drivers() {  # NAME DATASET
  start "$1_drivers" "$bin/fleetloc-play" "$2" --sensors "$out/$1.sensors.yaml" --rate "$rate" \
    --wait 60
  drivers+=("$child")
}

# Waits for the end of the recordings, before which nobody else may end; then ends the robots.
wait_for_robots() {
  local ended status i
  while [ ${#drivers[@]} -gt 0 ]; do
    status=0
    wait -n -p ended "${drivers[@]}" "${robots[@]}" "${localizers[@]}" || status=$?
    [[ " ${drivers[*]} " == *" $ended "* ]] || status="$status, too early"
    has_ended "$ended" "$status"
    for i in "${!drivers[@]}"; do
      [ "${drivers[$i]}" != "$ended" ] || unset "drivers[$i]"
    done
  done
  kill -TERM "${robots[@]}"
  for ended in "${robots[@]}"; do
    status=0
    wait "$ended" || status=$?
    has_ended "$ended" "$status"
  done
}
has_ended() {  # CHILD STATUS
  local name=${name_of[$1]}
  unset "name_of[$1]"
  [ "$2" = 0 ] || fail "$name ended with exit code $2$(last_words "$name")"
}
last_words() {  # NAME
  [ ! -s "$out/$1.log" ] || echo ": $(tail -n 1 "$out/$1.log")"
}

build() {
  sh "$root/deploy/install-deps.sh" || exit $?
  begin build
  run sh "$root/deploy/build.sh" release "$@" || fail "the build failed"
  finish
}

recorded_flight() {
  local truth=$dataset/$truth_in
  build fleetloc-map fleetloc-cloud fleetloc-robot fleetloc-play fleetloc-eval
  begin map
  run "$bin/fleetloc-map" build --cloud "$dataset/mav0/pointcloud0/data.ply" --out "$out/map.pcd" ||
    fail "no map"
  finish
  [ -n "$initial_pose" ] || initial_pose=$(start_pose "$dataset" "$truth")
  begin run "localizer and robot, DDS domain $domain, rate $rate"
  start_localizers "$out/map.pcd" "$root/qos_profiles/lan.xml" localizer_1
  grep serving "$out/localizer_1.log"
  start_robot robot_1 "$dataset" "$root/qos_profiles/lan.xml" --initial-pose "$initial_pose"
  start_drivers robot_1 "$dataset"
  wait_for_robots
  end "${localizers[@]}"
  finish
  echo "== errors"
  "$bin/fleetloc-eval" --run "$out/robot_1" --ground-truth "$truth"
  echo "run folders: $out/robot_1, $out/localizer_1"
}

made_up_world() {
  local demo=$root/deploy/worlds/demo world=$out/world name
  local truths=() runs=() folders=() sessions=() told
  local names=(robot_1 robot_2) localizer_names=(localizer_1 localizer_2)
  build fleetloc-sim fleetloc-map fleetloc-cloud fleetloc-robot fleetloc-play fleetloc-eval \
    fleetloc-monitor
  rm -rf "$out/report.html" "$out/summary.json"

  begin map "a survey with lidar in summer, and the map made of it"
  run "$demo/make.sh" map "$world" "$bin" || fail "no map"
  finish

  begin drives "what the robots will see in autumn"
  run "$demo/make.sh" drives "$world" "$bin" || fail "no drives"
  for name in "${names[@]}"; do truths+=("$world/truth/$name.csv"); done
  finish

  begin run "${#names[@]} robots and ${#localizer_names[@]} localizers, DDS domain $domain, rate $rate"
  start_localizers "$world/map/map.pcd" "$root/qos_profiles/nbiot.xml" "${localizer_names[@]}"
  for name in "${names[@]}"; do
    told=()
    [ "$name" = robot_2 ] || told=(--initial-pose "$(cat "$world/drives/$name.start")")
    start_robot "$name" "$world/drives/$name" "$root/qos_profiles/nbiot.xml" \
      --link "$demo/link.yaml" "${told[@]}"
    start_drivers "$name" "$world/drives/$name" >"$out/${name}_drivers.log" 2>&1
    runs+=("$out/$name")
  done
  for name in "${localizer_names[@]}"; do
    folders+=("$out/$name")
    sessions+=("$out/$name/sessions.json")
  done
  start monitor "$bin/fleetloc-monitor" --run "${runs[@]}" --ground-truth "${truths[@]}" \
    --localizer "${folders[@]}"
  monitor=$child
  wait_for_robots
  end "${localizers[@]}"
  wait "$monitor" || fail "the monitor failed"
  unset "name_of[$monitor]"
  finish

  begin report
  run "$bin/fleetloc-eval" --run "${runs[@]}" --ground-truth "${truths[@]}" \
    --report "$out/report.html" --map "$world/map/map.pcd" --sessions "${sessions[@]}" ||
    fail "no report"
  finish
  write_summary >"$out/summary.json"
  echo "report: $out/report.html"
  echo "all files: $out/summary.json"
}

# Each argument as a string of JSON, with commas between them. Paths are relative to the summary.
quoted() {
  local text='' word
  for word in "$@"; do text+=", \"${word#"$out/"}\""; done
  echo "${text#, }"
}

# Uses what made_up_world() has found out.
write_summary() {
  local IFS=,
  cat <<JSON
{
  "robots": [$(quoted "${runs[@]}")],
  "ground_truth": [$(quoted "${truths[@]}")],
  "sessions": [$(quoted "${sessions[@]}")],
  "map": "world/map/map.pcd",
  "report": "report.html",
  "stages": [${stages[*]}]
}
JSON
}

if [ -n "$dataset" ]; then recorded_flight; else made_up_world; fi
