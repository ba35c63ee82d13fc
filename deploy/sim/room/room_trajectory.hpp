#pragma once

#include <Eigen/Core>

#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// Exact motion at one instant; the frame of the room has its origin on the floor, z up.
struct Motion {
  Pose T_room_body;
  Eigen::Vector3d v_room = Eigen::Vector3d::Zero();            ///< [m/s]
  Eigen::Vector3d a_room = Eigen::Vector3d::Zero();            ///< [m/s^2]
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< in body [rad/s]
};

/// A closed curve through the room, a sum of sines in position and in yaw, pitch and roll, with all
/// derivatives in closed form. The camera (the body's z axis) pans along the path.
class RoomTrajectory {
 public:
  /// On the way, after `at_s`, when the robot is at full speed: it slows down within two seconds,
  /// stands, and goes on. Zero: no stop.
  struct Stop {
    double at_s;
    double stands_s;
  };

  /// @param rest_s  stands still that long, then speeds up within two seconds; zero: at full speed
  ///                from the start
  /// @param speed   root mean square over one round [m/s]
  RoomTrajectory(double rest_s, double speed, const Stop& stop = {});

  [[nodiscard]] Motion at(double time_s) const;

  /// After which, at full speed, the motion repeats.
  [[nodiscard]] double round_s() const;

 private:
  double rest_s_;
  Stop stop_;
  double rounds_rate_;  ///< of the curve's parameter, once at full speed [rad/s]
};

}  // namespace fleetloc
