#pragma once

#include <Eigen/Core>

#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// Largest sigma over all directions, in the unit of the covariance's root. NaN if the covariance
/// has one, or is negative along all directions.
double max_sigma(const Eigen::Matrix3d& covariance);

/// Diagonal covariance of a perturbation of a pose: the same sigma about all axes [rad], and along
/// all axes [m].
Matrix6d diagonal_covariance(double sigma_rad, double sigma_m);

}  // namespace fleetloc
