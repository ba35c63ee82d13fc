#pragma once

#include <vector>

#include "shared/core/time.hpp"

namespace fleetloc {

struct Outage {
  double from_s{};
  double for_s{};
};

/// One outage every so often.
struct PeriodicOutage {
  double every_s{};  ///< 0: none
  double from_s{};   ///< of the first
  double for_s{};
};

/// When nothing passes.
struct Outages {
  std::vector<Outage> at{};
  PeriodicOutage periodic{};
};

/// @param elapsed  since the first datagram
bool is_out(const Outages& outages, Duration elapsed);

}  // namespace fleetloc
