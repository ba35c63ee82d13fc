#pragma once

#include <Eigen/Core>

namespace fleetloc {

/// Largest sigma over all directions, in the unit of the covariance's root. NaN for a covariance
/// that is not positive semi-definite.
double max_sigma(const Eigen::Matrix3d& covariance);

}  // namespace fleetloc
