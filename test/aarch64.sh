#!/bin/sh
# aarch64.sh [--install] SUBMAPS ANSWERS
# Whether an aarch64 decodes the test vectors of the compact encoding (two files of compact_vectors)
# to the same bits: builds the coder for it and runs it in an emulator. No library but the C++ one is
# linked, so no package of another architecture is needed.
# Without the cross compiler or the emulator it skips, and says so; --install fetches them (118 MB,
# 600 MB on disk).
# Exit 0: the same, or skipped. 1: other bits.
set -eu

root=$(cd "$(dirname "$0")/.." && pwd)
packages="g++-aarch64-linux-gnu qemu-user-static"
if [ "${1:-}" = --install ]; then
  shift
  # shellcheck disable=SC2086  # words on purpose
  sh "$root/deploy/install-deps.sh" $packages
fi
if [ $# != 2 ]; then
  echo "usage: test/aarch64.sh [--install] SUBMAPS ANSWERS" >&2
  exit 2
fi

compiler=$(command -v aarch64-linux-gnu-g++) || compiler=""
emulator=$(command -v qemu-aarch64-static) || emulator=""
if [ -z "$compiler" ] || [ -z "$emulator" ]; then
  echo "aarch64: skipped: needs the packages $packages (test/aarch64.sh --install)"
  exit 0
fi

# Beside the vectors; a change of the sources builds anew.
build=$(dirname "$1")/aarch64
mkdir -p "$build/include"
# Headers without machine code. /usr/include itself has those of this machine's C library.
for headers in eigen3/Eigen nlohmann tl; do
  ln -sfn "/usr/include/$headers" "$build/include/${headers##*/}"
done

cd "$root"
# As fleetloc_embed() does it.
mkdir -p "$build/include/shared/compact"
{
  printf '#pragma once\n#include <string_view>\n'
  printf 'namespace fleetloc {\ninline constexpr std::string_view kCompactModelsText = R"embedded('
  cat idl/compact_models.txt
  printf ')embedded";\n}\n'
} >"$build/models.hpp"
cmp -s "$build/models.hpp" "$build/include/shared/compact/compact_models_text.hpp" ||
  cp "$build/models.hpp" "$build/include/shared/compact/compact_models_text.hpp"

sources="shared/coding/range_decoder.cpp shared/coding/range_encoder.cpp
  shared/compact/compact_submap.cpp shared/compact/correction_block.cpp
  shared/compact/observation_predictor.cpp shared/compact/quantization.cpp
  shared/compact/strict_pose.cpp shared/compact/submap_block.cpp shared/compact/trained_models.cpp
  shared/compact/turn.cpp
  shared/geometry/*.cpp shared/wire/malformed.cpp test/unit/compact/check_vectors.cpp"
for source in $sources; do
  object=$build/$(basename "$source" .cpp).o
  if [ -e "$object" ] &&
    [ -z "$(find shared test/unit/compact "$build/include/shared" -name '*.[ch]pp' -newer "$object" | head -n 1)" ]; then
    continue
  fi
  # As the project builds shared/compact.
  "$compiler" -std=c++20 -O2 -ffp-contract=off -I. -isystem "$build/include" \
    -c "$source" -o "$object"
done
"$compiler" -static "$build"/*.o -o "$build/check_vectors"
"$emulator" "$build/check_vectors" "$1" "$2"
