#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "shared/core/ids.hpp"
#include "shared/core/time.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/model/pose_estimate.hpp"

namespace fleetloc {

inline constexpr std::size_t kMaxPossiblePlaces = 16;

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
  /// Of the body in the map [m], the likeliest first; empty unless what it has seen fits several
  /// places. At most kMaxPossiblePlaces.
  std::vector<Eigen::Vector3d> possible_places = {};
};

}  // namespace fleetloc
