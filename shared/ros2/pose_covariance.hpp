#pragma once

#include <array>
#include <span>

#include "shared/geometry/pose.hpp"
#include "shared/ros2/ros2_refusal.hpp"

namespace fleetloc {

/// Row-major: x, y, z of frame a [m], then rotations about the fixed axes of frame a [rad].
using Ros2Covariance = std::array<double, 36>;

/// Covariance of T_a_b in the order and axes of geometry_msgs/PoseWithCovariance. Ours is of xi in
/// T_a_b * Exp(xi), which is [rotation, translation] in frame b. To first order the position moves
/// by R_a_b * translation, and the rotation about the axes of a is R_a_b * rotation.
/// @param R_a_b  of the pose
Ros2Covariance to_ros2_covariance(const Matrix6d& covariance, const Eigen::Quaterniond& R_a_b);

/// Inverse of to_ros2_covariance.
Matrix6d from_ros2_covariance(std::span<const double, 36> covariance,
                              const Eigen::Quaterniond& R_a_b);

/// Of [angular, linear] velocities in the body's frame, in the order of TwistWithCovariance.
Ros2Covariance to_ros2_twist_covariance(const Matrix6d& covariance);

/// Finite, symmetric, positive semi-definite: all within rounding.
Ros2Validity check_covariance(std::span<const double, 36> covariance);

}  // namespace fleetloc
