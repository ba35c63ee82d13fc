#pragma once

#include <Eigen/Core>

#include "shared/model/inertial.hpp"

namespace fleetloc {

// A pose that was wrong moves what was estimated relative to it as a rigid body: the Jacobian of a
// state's tangent (15, see NavState) with respect to that pose. Biases do not move.

/// With respect to yaw [rad] and position [m, in odom] of T_odom_other: columns yaw, x, y, z.
Eigen::Matrix<double, 15, 4> jacobian_by_yaw_and_position(const Pose& T_odom_other,
                                                          const NavState& state);

/// With respect to the right perturbation [rotation rad, translation m] of T_odom_other.
Eigen::Matrix<double, 15, 6> jacobian_by_pose(const Pose& T_odom_other, const NavState& state);

}  // namespace fleetloc
