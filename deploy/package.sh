#!/bin/sh
# deploy/package.sh   builds the programs, and makes Debian packages of them in build/packages
set -eu

cd "$(dirname "$0")/.."
[ $# -eq 0 ] || { echo "usage: deploy/package.sh" >&2; exit 2; }
sh deploy/install-deps.sh dpkg-dev file || exit $?
sh deploy/build.sh release fleetloc-robot fleetloc-cloud fleetloc-eval fleetloc-experiment \
  fleetloc-map fleetloc-monitor fleetloc-play fleetloc-replay fleetloc-sim fleetloc-topic

# The same sources make the same bytes: files are dated by the commit, or by the newest of them.
SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct 2>/dev/null || date +%s -r CMakeLists.txt)}
export SOURCE_DATE_EPOCH
rm -rf build/packages
(umask 022 && cd build/release && cpack -G DEB) >build/packages.log 2>&1 || {
  cat build/packages.log >&2
  echo "package: FAILED: cpack -G DEB in build/release" >&2
  exit 1
}
rm -rf build/packages/_CPack_Packages build/packages.log
(cd build/packages && du -h -- *.deb)
