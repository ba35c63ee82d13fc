#pragma once

#include <idl/common.h>

#include "shared/model/pose_estimate.hpp"
#include "shared/wire/malformed.hpp"

namespace fleetloc {

// The enumerations list the same values in the same order.
static_assert(static_cast<int>(Quality::kInitializing) == wire::POSE_INITIALIZING);
static_assert(static_cast<int>(Quality::kLocalized) == wire::POSE_LOCALIZED);
static_assert(static_cast<int>(Quality::kDeadReckoning) == wire::POSE_DEAD_RECKONING);
static_assert(static_cast<int>(Quality::kLost) == wire::POSE_LOST);
static_assert(static_cast<int>(Quality::kSearching) == wire::POSE_SEARCHING);

constexpr wire::Quality to_wire(Quality quality) {
  return static_cast<wire::Quality>(quality);
}
constexpr Quality from_wire(wire::Quality quality) {
  return static_cast<Quality>(quality);
}

constexpr Validity check(wire::Quality quality) {
  if (quality > wire::POSE_SEARCHING) return unexpected(Malformed::kUnknownValue);
  return {};
}

}  // namespace fleetloc
