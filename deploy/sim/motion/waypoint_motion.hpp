#pragma once

#include <vector>

#include <Eigen/Core>

#include "deploy/sim/motion/motion_extremes.hpp"
#include "deploy/sim/motion/spline_motion.hpp"

namespace fleetloc {

/// A route over the ground. The body's axes are x forward along the route, y left, z up.
struct WaypointRoute {
  std::vector<Eigen::Vector3d> waypoints_m;  ///< of the body, in map
  double speed = 1.2;                        ///< where no limit is lower [m/s]
  double rest_s = 2.0;  ///< standing still at the start, to initialize the odometry
  double corner_radius_m = 3.0;
  bool loop = false;     ///< back to the first waypoint
  int laps = 1;          ///< of a loop
  bool reverse = false;  ///< from its end to its beginning
};

/// All waypoints in the order of the drive, laps included.
std::vector<Eigen::Vector3d> driven_waypoints(const WaypointRoute& route);

/// Drives along the route as fast as speed and limits permit, from rest to rest. Pitch follows the
/// slope. Sideways and lengthwise acceleration each get six tenths of the limit, so that both and
/// their smoothing stay below it. Throws std::invalid_argument as rounded_path() does.
SplineMotion drive(const WaypointRoute& route, const MotionMagnitudes& limits);

}  // namespace fleetloc
