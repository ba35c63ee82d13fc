#pragma once

#include <algorithm>
#include <chrono>
#include <optional>

#include "shared/core/time.hpp"

namespace fleetloc {

/// Time for timers, of a clock that may be set: it runs with that clock, but never back, and by no
/// leap forward that is longer than a second. So a clock that is set ends no wait, lets no timeout
/// pass, and makes no round trip of it. Expects to be called more often than once a second.
class SteadyTime {
 public:
  Timestamp operator()(Timestamp clock) {
    constexpr Duration kLongestStep = std::chrono::seconds(1);
    if (!clock_) {
      time_ = clock;
    } else {
      time_ += std::clamp(clock - *clock_, Duration{}, kLongestStep);
    }
    clock_ = clock;
    return time_;
  }

 private:
  std::optional<Timestamp> clock_;  // as it was passed in last
  Timestamp time_{};
};

}  // namespace fleetloc
