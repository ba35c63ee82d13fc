#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// x and y of gravity's upward direction as the map sees it, in odom: zero if the map is level.
struct MapTilt {
  Eigen::Vector2d value;
  Eigen::Matrix<double, 2, 3> J_rotation;  ///< by the right perturbation of R_map_odom
};

MapTilt tilt_of(const Eigen::Quaterniond& R_map_odom);

/// Chi-square of the tilt, 2 degrees of freedom.
/// @param covariance  of T_map_odom, right perturbation
/// @param map_tilt    sigma of the map's z axis against gravity [rad]
double chi_square(const MapTilt& tilt, const Matrix6d& covariance, double map_tilt);

}  // namespace fleetloc
