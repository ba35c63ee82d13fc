#pragma once

#include <cstdint>
#include <optional>

#include "shared/core/ids.hpp"
#include "shared/core/time.hpp"
#include "shared/model/pose_estimate.hpp"

namespace fleetloc {

/// Status of a robot, for its localizer.
struct RobotStatus {
  RobotId robot;
  SessionNumber session{};
  Timestamp start_stamp;  ///< of the session; tells two robots with one id apart
  Timestamp stamp;
  Quality quality = Quality::kInitializing;
  std::uint64_t submaps_sent = 0;  ///< since the program started, like the next one
  std::uint64_t answers_applied = 0;
  std::optional<Duration> round_trip;  ///< from a submap to its answer
};

}  // namespace fleetloc
