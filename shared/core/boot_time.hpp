#pragma once

#include <chrono>
#include <ctime>

#include "shared/core/arrival_time.hpp"

namespace fleetloc {

/// The clock of arrivals as it is now. For nodes and transports; everything below is told.
inline ArrivalTime boot_time() {
  timespec time{};
  clock_gettime(CLOCK_BOOTTIME, &time);
  return ArrivalTime(std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec));
}

}  // namespace fleetloc
