#pragma once

#include <optional>
#include <string>

#include "shared/core/ids.hpp"
#include "shared/core/time.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/model/pose_estimate.hpp"

namespace fleetloc {

/// A robot as one localizer knows it, for those who watch the fleet.
struct ServedRobot {
  std::string localizer = {};
  RobotId robot = {};
  SessionNumber session{};
  Quality quality{};                    ///< as the robot has told it last
  std::optional<Pose> T_map_body = {};  ///< of the newest answer
  Matrix6d covariance = Matrix6d::Zero();
  double up_bytes_per_s = 0.0;  ///< of the latest seconds, headers included
  double down_bytes_per_s = 0.0;
  Duration silent{};  ///< since its last message
  std::optional<Duration> round_trip = {};
};

}  // namespace fleetloc
