#pragma once

#include <Eigen/Core>

#include "shared/core/time.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// One IMU measurement, in the body frame.
struct ImuSample {
  Timestamp stamp;
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< [rad/s]
  Eigen::Vector3d specific_force = Eigen::Vector3d::Zero();    ///< [m/s^2], +g upwards at rest
};

/// Whether a sensor can have measured it: finite, at most 100 rad/s and 1000 m/s^2 along each axis.
[[nodiscard]] inline bool is_possible(const ImuSample& sample) {
  constexpr double kFastest = 100.0;
  constexpr double kStrongest = 1000.0;
  return (sample.angular_velocity.array().abs() <= kFastest).all() &&
         (sample.specific_force.array().abs() <= kStrongest).all();
}

/// Model of the motion while IMU samples are missing. All zero: intervals of any length are
/// integrated as measured.
struct ImuGapModel {
  /// Across longer intervals the readings are interpolated, with their true values as a random walk
  /// from one end.
  double bridged_from_s = 0.0;
  double angular_acceleration = 0.0;  ///< of that walk [rad/s^2/sqrt(Hz)]
  double jerk = 0.0;                  ///< of that walk [m/s^3/sqrt(Hz)]
  /// After still longer ones the motion is unknown until the odometry is reset: the pose stays
  /// constant, and its covariance grows as for an unknown constant velocity (one sigma each axis).
  double void_from_s = 0.0;
  double speed_sigma = 0.0;      ///< [m/s]
  double turn_rate_sigma = 0.0;  ///< [rad/s]
};

/// Continuous-time noise of an IMU, as in EuRoC's sensor.yaml.
struct ImuNoise {
  double gyroscope_noise_density = 0.0;      ///< [rad/s/sqrt(Hz)]
  double gyroscope_random_walk = 0.0;        ///< [rad/s^2/sqrt(Hz)]
  double accelerometer_noise_density = 0.0;  ///< [m/s^2/sqrt(Hz)]
  double accelerometer_random_walk = 0.0;    ///< [m/s^3/sqrt(Hz)]
  ImuGapModel gaps = {};
};

struct ImuBias {
  Eigen::Vector3d gyroscope = Eigen::Vector3d::Zero();      ///< [rad/s]
  Eigen::Vector3d accelerometer = Eigen::Vector3d::Zero();  ///< [m/s^2]
};

/// Tangent of a NavState: [rotation rad, translation m (both right perturbations of the pose),
/// velocity m/s in odom, gyroscope bias, accelerometer bias].
using Vector15d = Eigen::Matrix<double, 15, 1>;
using Matrix15d = Eigen::Matrix<double, 15, 15>;

/// State of inertial navigation at one instant.
struct NavState {
  Pose T_odom_body;
  Eigen::Vector3d v_odom = Eigen::Vector3d::Zero();  ///< of body [m/s]
  ImuBias bias;
};

/// state [+] tangent.
inline NavState retract(const NavState& state, const Vector15d& tangent) {
  return {
      retract(state.T_odom_body, tangent.head<6>()),
      state.v_odom + tangent.segment<3>(6),
      {state.bias.gyroscope + tangent.segment<3>(9), state.bias.accelerometer + tangent.tail<3>()}};
}

/// Standard gravity in a gravity-aligned frame with z up [m/s^2]: at rest the specific force is -g.
inline const Eigen::Vector3d kGravity{0.0, 0.0, -9.81};

/// The odometry's estimate at one instant.
struct OdometryEstimate {
  Timestamp stamp;
  NavState state;
  Matrix15d covariance = Matrix15d::Zero();
  bool is_standing = false;  ///< the body has not moved since the estimate before
};

}  // namespace fleetloc
