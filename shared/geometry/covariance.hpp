#pragma once

#include <Eigen/Core>

namespace fleetloc {

/// Standard deviation in the direction in which it is greatest, of any unit.
double greatest_sigma(const Eigen::Matrix3d& covariance);

}  // namespace fleetloc
