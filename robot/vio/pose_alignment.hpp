#pragma once

#include <span>
#include <vector>

#include "shared/model/camera.hpp"
#include "shared/model/observation.hpp"

namespace fleetloc {

/// A landmark whose position is fixed, and its observation in a frame.
struct KnownPoint {
  Eigen::Vector3d p_odom = Eigen::Vector3d::Zero();
  StereoObservation observation;
  double pixel_sigma = 1.0;  ///< [px]
};

/// Gauss-Newton system of the reprojection errors in the tangent of T_odom_body: H d = -g.
struct PoseSystem {
  Matrix6d H = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
  int inliers = 0;                   ///< errors below `outlier_sigmas`; others are not used
  std::vector<LandmarkId> outliers;  ///< those others, in the order of the points
};
struct RobustKernel {
  double huber_sigmas = 0.0;
  double outlier_sigmas = 0.0;  ///< beyond it a point is ignored
};
PoseSystem linearize(std::span<const KnownPoint> points,
                     const RectifiedStereo& stereo,
                     const Pose& T_odom_body,
                     const RobustKernel& kernel);

}  // namespace fleetloc
