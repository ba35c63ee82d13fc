#pragma once

#include <ceres/sized_cost_function.h>

#include "shared/factors/parameters.hpp"
#include "shared/model/camera.hpp"
#include "shared/model/observation.hpp"

namespace fleetloc {

/// Measurement noise of the rectified pair.
struct StereoNoise {
  double pixel_sigma = 1.0;  ///< of u_left, v and u_right alike [px]
};

/// T_cam0_body, as factors need it.
struct CameraMounting {
  explicit CameraMounting(const Pose& T_body_cam0);

  Eigen::Matrix3d R_cam0_body;
  Eigen::Vector3d p_cam0;  ///< of the body's origin [m]
};

/// Stereo reprojection error (paper, eq. 1), whitened: (u_left, v, u_right) of a landmark seen from
/// a keyframe. Parameters: T_world_body (7), p_world (3). The world is odom or map.
///
/// `first_estimate`, if given, is the pose at which both Jacobians are taken instead of its current
/// value (first-estimate Jacobians); it must outlive the factor. A point that is not in front of
/// the camera has a residual of 500 px and no gradient.
class StereoReprojectionFactor final : public ceres::SizedCostFunction<3, 7, 3> {
 public:
  StereoReprojectionFactor(const StereoObservation& observation,
                           const RectifiedStereo& stereo,
                           StereoNoise noise,
                           const PoseParameters* first_estimate = nullptr);
  bool Evaluate(const double* const* parameters,
                double* residuals,
                double** jacobians) const override;

 private:
  Eigen::Vector3d measured_;  // u_left, v, u_right [px]
  RectifiedStereo stereo_;
  CameraMounting camera_;
  double inverse_sigma_;
  const PoseParameters* first_estimate_;
};

/// The same for a landmark that only the left camera sees: (u, v).
class MonoReprojectionFactor final : public ceres::SizedCostFunction<2, 7, 3> {
 public:
  MonoReprojectionFactor(const StereoObservation& observation,
                         const RectifiedStereo& stereo,
                         StereoNoise noise,
                         const PoseParameters* first_estimate = nullptr);
  bool Evaluate(const double* const* parameters,
                double* residuals,
                double** jacobians) const override;

 private:
  Eigen::Vector2d measured_;  // [px]
  RectifiedStereo stereo_;
  CameraMounting camera_;
  double inverse_sigma_;
  const PoseParameters* first_estimate_;
};

}  // namespace fleetloc
