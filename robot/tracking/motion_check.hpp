#pragma once

#include <vector>

#include <Eigen/Core>

#include "shared/config/config_reader.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/model/camera.hpp"

namespace fleetloc {

struct MotionCheckConfig {
  double inlier_px;            ///< largest distance of an inlier from its predicted pixel or line
  int hypotheses;              ///< of RANSAC, at most
  int min_points;              ///< with a depth, to estimate a motion with a scale
  double nearest_m;            ///< smallest possible depth
  double rotation_sigma_rad;   ///< of the predicted rotation
  double translation_sigma_m;  ///< of the predicted translation
};

MotionCheckConfig read_motion_check_config(ConfigReader section);

/// A point that was tracked from one left image to the next [px of the rectified pair].
struct Correspondence {
  Eigen::Vector2d previous = Eigen::Vector2d::Zero();
  Eigen::Vector2d current = Eigen::Vector2d::Zero();
  double disparity = 0.0;  ///< in the previous frame; 0: not known
};

struct RigidMotion {
  std::vector<bool> inliers;         ///< one per correspondence
  std::vector<double> distances_px;  ///< from the predicted pixel or line, one per correspondence
  Pose T_current_previous;           ///< of the rectified left camera
  bool has_translation = false;      ///< false: only the rotation is valid, the predicted one
};

/// Outlier rejection: camera motion and its inliers by RANSAC with a fixed seed. Points with a
/// depth determine the motion, rotation included, so a biased or missing prediction is corrected;
/// standstill and pure rotation are not degenerate. Points without a depth must then lie on the
/// segment of their epipolar line that is in front of the camera. With fewer than min_points depths
/// the predicted rotation is used, and only the direction of the translation is estimated.
RigidMotion estimate_rigid_motion(const std::vector<Correspondence>& correspondences,
                                  const RectifiedStereo& stereo,
                                  const Pose& predicted_T_current_previous,
                                  const MotionCheckConfig& config);

}  // namespace fleetloc
