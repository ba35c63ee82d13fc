#pragma once

#include <Eigen/Core>

#include "shared/geometry/covariance.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// A pose in the map with the covariance of its right perturbation.
struct PoseWithCovariance {
  Pose T_map_body;
  Matrix6d covariance = Matrix6d::Identity();
};

}  // namespace fleetloc
