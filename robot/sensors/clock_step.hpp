#pragma once

#include "shared/core/time.hpp"

namespace fleetloc {

/// The clock of the sensors was set, forward or back: all that follows is stamped by it as it is
/// from now on.
struct ClockStep {
  Timestamp stamp;    ///< of the first IMU sample that follows
  Duration unseen{};  ///< real time between that sample and the last one before, as it arrived
};

}  // namespace fleetloc
