#pragma once

#include <vector>

#include "shared/core/time.hpp"

namespace fleetloc {

struct RateStep {
  double time_s{};       ///< from then on
  double bytes_per_s{};  ///< 0: nothing passes
};

/// A rate that changes at its steps.
struct RateTrace {
  std::vector<RateStep> steps;  ///< ascending, the first at 0; empty: no trace
  double repeat_s{};            ///< begins again after that long; 0: the last rate holds
};

/// A rate, and when it changes next.
struct HeldRate {
  double bytes_per_s{};
  Duration until{};  ///< Duration::max(): never
};

/// @param trace    with a step at least
/// @param elapsed  since the trace began, not negative
HeldRate rate_at(const RateTrace& trace, Duration elapsed);

}  // namespace fleetloc
