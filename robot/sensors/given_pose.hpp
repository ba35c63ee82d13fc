#pragma once

#include "shared/core/time.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// Somebody tells where the robot is in the map.
struct GivenPose {
  Timestamp stamp{};  ///< when the robot was there, by the clock of the sensors
  Pose T_map_body{};
  /// Right perturbation of T_map_body. Along an axis of the map whose variance is zero nothing is
  /// known of it: there that of a start pose is used.
  Matrix6d covariance = Matrix6d::Zero();
};

}  // namespace fleetloc
