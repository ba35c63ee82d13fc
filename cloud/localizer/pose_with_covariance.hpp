#pragma once

#include <Eigen/Core>

#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// A pose in the map with the covariance of its right perturbation.
struct PoseWithCovariance {
  Pose T_map_body;
  Matrix6d covariance = Matrix6d::Identity();
};

/// Diagonal covariance of a perturbation: the same sigma about all axes, and along all axes.
inline Matrix6d diagonal_covariance(double sigma_rad, double sigma_m) {
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(sigma_rad * sigma_rad),
      Eigen::Vector3d::Constant(sigma_m * sigma_m);
  return variances.asDiagonal();
}

}  // namespace fleetloc
