#pragma once

#include <optional>
#include <span>
#include <vector>

#include "robot/inertial/preintegration.hpp"

namespace fleetloc {

/// Visual-inertial alignment of a visual trajectory (as in VINS-Mono). `first` is the frame of the
/// trajectory, not aligned with gravity.
struct InertialAlignment {
  ImuBias bias;
  Eigen::Vector3d g_first = Eigen::Vector3d::Zero();  ///< |g| = 9.81 [m/s^2]
  std::vector<Eigen::Vector3d> v_first;               ///< of body, at every pose [m/s]
  double estimated_gravity = 0.0;                     ///< |g| without the constraint [m/s^2]
};

struct AlignmentNoise {
  double position_sigma_m = 0.0;          ///< of the trajectory, between neighbours
  double accelerometer_bias_sigma = 0.0;  ///< about zero [m/s^2]
};

/// Gyroscope bias from the rotations, then velocities, gravity and accelerometer bias linearly.
/// @param T_first_body  at the ends of `between`, at least three; scale known
InertialAlignment align_inertially(std::span<const Pose> T_first_body,
                                   std::vector<Preintegration> between,
                                   const AlignmentNoise& noise);

}  // namespace fleetloc
