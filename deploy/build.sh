#!/bin/sh
# deploy/build.sh PRESET [TARGET...]   configures and builds build/PRESET, everything by default
set -eu

cd "$(dirname "$0")/.."
[ $# -ge 1 ] || { echo "usage: deploy/build.sh PRESET [TARGET...]" >&2; exit 2; }
preset=$1
shift

# They would bring in another Fast DDS: a sourced ROS, conda.
unset CMAKE_PREFIX_PATH AMENT_PREFIX_PATH CONDA_PREFIX LD_LIBRARY_PATH || true

# Compilers take up to 2 GB each: CMake limits them by memory, see FleetlocTargets.cmake. In a
# container with less memory than its host, that is counted here.
limit=$(cat /sys/fs/cgroup/memory.max 2>/dev/null || echo max)
kilobytes=$(awk '/^MemAvailable:/ {print $2}' /proc/meminfo)
case $limit in
  max | "") ;;
  *) [ $((limit / 1024)) -ge "$kilobytes" ] || kilobytes=$((limit / 1024)) ;;
esac
jobs=$((kilobytes / 2000000 + 1))
cores=$(nproc)
[ "$jobs" -le "$cores" ] || jobs=$cores

# Where ccache is installed, a second clone compiles what the first one has not.
if [ -z "${CMAKE_CXX_COMPILER_LAUNCHER:-}" ] && command -v ccache >/dev/null; then
  export CMAKE_CXX_COMPILER_LAUNCHER=ccache
fi
export CCACHE_BASEDIR="$PWD" CCACHE_NOHASHDIR=1

echo "build: configuring $preset"
cmake --preset "$preset" -DFLEETLOC_COMPILE_JOBS="$jobs" >"build-$preset.log" 2>&1 || {
  cat "build-$preset.log" >&2
  rm -f "build-$preset.log"
  echo "build: FAILED: cmake --preset $preset" >&2
  exit 1
}
rm -f "build-$preset.log"
echo "build: building $preset, $jobs at once"
set -- ${1+--target} "$@"
cmake --build "build/$preset" --parallel "$jobs" "$@" || {
  echo "build: FAILED: cmake --build build/$preset" >&2
  exit 1
}
