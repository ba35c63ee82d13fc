#pragma once

#include <idl/submap.h>

#include "shared/wire/malformed.hpp"

namespace fleetloc {

/// Scales of the columns, as stated in submap.idl.
inline constexpr double kUnitsPerPixel = 32.0;
inline constexpr double kUnitsPerQuaternion = 1 << 30;
inline constexpr double kKeyframeUnitsPerMetre = 1e4;
inline constexpr double kEdgeUnitsPerMetre = 1e5;

inline constexpr std::size_t kRootSize = 21;  ///< entries of a SquareRoot6

/// What is wrong with a sample, its id apart; the whole trust boundary of a submap.
Validity check(const wire::Submap& sample);

}  // namespace fleetloc
