#pragma once

#include <chrono>

namespace fleetloc {

/// Clock of arrivals: it is never set, and goes on while the computer sleeps (CLOCK_BOOTTIME). It
/// has no now(): arrival times are passed in.
struct ArrivalClock {
  using duration = std::chrono::nanoseconds;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<ArrivalClock>;
  static constexpr bool is_steady = true;
};

using ArrivalTime = ArrivalClock::time_point;

}  // namespace fleetloc
