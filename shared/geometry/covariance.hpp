#pragma once

#include <Eigen/Core>

namespace fleetloc {

/// Standard deviation in the direction in which it is greatest, of any unit. NaN for a covariance
/// that is not positive semi-definite.
double max_sigma(const Eigen::Matrix3d& covariance);

}  // namespace fleetloc
