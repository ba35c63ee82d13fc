#pragma once

#include <Eigen/LU>

namespace fleetloc {

/// Orthonormal up to what calibrations are rounded to, and not a reflection.
inline bool is_rotation(const Eigen::Matrix3d& R) {
  constexpr double kTolerance = 1e-3;
  return (R.transpose() * R - Eigen::Matrix3d::Identity()).norm() < kTolerance &&
         R.determinant() > 0.0;
}

}  // namespace fleetloc
