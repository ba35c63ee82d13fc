#!/bin/sh
# install-deps.sh [PACKAGE...]
# Installs the Debian packages that the build and the tests need, and those named. Nothing missing:
# nothing touched.
# Exit 0: all there. 1: could not be installed. 2: needs a root that is not to be had.
set -eu

packages="g++ cmake ninja-build
  libpcl-dev libopencv-dev libceres-dev libfastrtps-dev libfastcdr-dev fastddsgen libyaml-cpp-dev
  libeigen3-dev libgtest-dev libgmock-dev libbenchmark-dev libcli11-dev libspdlog-dev
  nlohmann-json3-dev libnanoflann-dev libembree-dev libtinyxml2-dev libsystemd-dev libcpp-httplib-dev gnuplot-nox iproute2
  libkainjow-mustache-dev libxxhash-dev libexpected-dev python3 openssl libssl-dev
  fastdds-tools"

fail() {
  echo "install-deps: $1" >&2
  exit "${2:-1}"
}

installed() {
  test "$(dpkg-query -W -f '${db:Status-Abbrev}' "$1" 2>/dev/null | cut -c1-2)" = ii
}

command -v dpkg-query >/dev/null || fail "needs Debian 12 (no dpkg-query here)"
missing=""
for package in $packages "$@"; do
  installed "$package" || missing="$missing $package"
done
if [ -z "$missing" ]; then
  echo "install-deps: all packages are installed"
  exit 0
fi
echo "install-deps: missing:$missing"

if [ "$(id -u)" = 0 ]; then
  as_root=""
elif command -v sudo >/dev/null && { sudo -n true 2>/dev/null || [ -t 0 ]; }; then
  as_root=sudo
else
  echo "install-deps: run this as root, then start again:" >&2
  echo "  apt-get update && apt-get install -y --no-install-recommends$missing" >&2
  exit 2
fi
# The set-up of the JDK, which fastddsgen brings, reads it.
[ -e /proc/self/exe ] || fail "/proc must be mounted"

apt() {
  # shellcheck disable=SC2086  # words on purpose
  $as_root env DEBIAN_FRONTEND=noninteractive LC_ALL=C apt-get -o DPkg::Lock::Timeout=300 "$@"
}

# apt's own words, as "12.3 MB", in bytes.
bytes() {
  awk -v words="$1" 'BEGIN {
    split(words, word, " "); gsub(",", "", word[1])
    factor["B"] = 1; factor["kB"] = 1e3; factor["MB"] = 1e6; factor["GB"] = 1e9
    printf "%.0f", word[1] * factor[word[2]]
  }'
}

echo "install-deps: apt-get update"
apt update -qq || fail "apt-get update failed"
# shellcheck disable=SC2086
plan=$(apt install --no-install-recommends --assume-no $missing 2>&1) || true
fetch=$(printf '%s\n' "$plan" | sed -n 's/^Need to get \([^/]*\)\(\/.*\)\{0,1\} of archives.*/\1/p')
disk=$(printf '%s\n' "$plan" | sed -n 's/^After this operation, \(.*\) of additional disk space.*/\1/p')
[ -n "$fetch" ] || fail "apt-get cannot install:$missing: $(printf '%s\n' "$plan" | tail -n 1)"
# "12 MB/731 MB" means that some of it has been fetched before.
fetch_word=$(printf '%s' "$fetch" | awk '{print $1, $2}')
echo "install-deps: $fetch_word to fetch, ${disk:-0 B} on disk"

need=$(awk -v a="$(bytes "$fetch_word")" -v b="$(bytes "${disk:-0 B}")" 'BEGIN {printf "%.0f", (a + b) / 1024}')
free=$(df -Pk /usr | awk 'NR == 2 {print $4}')
[ "$free" -gt "$need" ] || fail "no room: $need KB are needed in /usr, $free KB are free"

# shellcheck disable=SC2086
apt install -y -qq --no-install-recommends $missing || fail "apt-get install failed, see above"
for package in $missing; do
  installed "$package" || fail "$package is not installed in spite of apt-get"
done
echo "install-deps: done"
