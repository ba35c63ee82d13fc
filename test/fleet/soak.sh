#!/bin/sh
# soak.sh [--minutes N] [--seed S] [--out DIR]   as test/fleet/soak.cpp, which it builds
# Needs a Docker daemon and fast-discovery-server. Everything that it makes is removed afterwards.
set -eu

root=$(cd "$(dirname "$0")/../.." && pwd)
sh "$root/deploy/build.sh" release fleet_soak
exec "$root/build/release/bin/fleet_soak" "$@"
