#pragma once

#include <chrono>
#include <ctime>

#include "shared/core/time.hpp"

namespace fleetloc {

/// Processor time of the calling thread, for reports only.
inline Duration thread_cpu_time() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

}  // namespace fleetloc
