#pragma once

#include <Eigen/Core>

#include "cloud/localizer/degeneracy.hpp"
#include "cloud/localizer/pose_with_covariance.hpp"

namespace fleetloc {

/// Covariance of `result`, raised along the weak directions to at least `min_covariance`.
Matrix6d widened_along(const WeakDirections& weak,
                       const WindowMotion& motion,
                       const PoseWithCovariance& result,
                       const Matrix6d& min_covariance);

/// The largest standard deviation of `result` along a weak direction [m]; zero without any.
double weak_sigma(const WeakDirections& weak,
                  const WindowMotion& motion,
                  const PoseWithCovariance& result);

}  // namespace fleetloc
