#pragma once

#include <vector>

#include <Eigen/Core>

#include "shared/config/config_reader.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/model/camera.hpp"

namespace fleetloc {

struct MotionCheckConfig {
  double inlier_px;           ///< largest distance from where the motion of the camera puts a point
  int hypotheses;             ///< of the motion, at most
  int min_points;             ///< with a depth, to estimate a motion with a scale
  double nearest_m;           ///< no point is nearer
  double rotation_sigma_rad;  ///< of the predicted rotation
  double translation_sigma_m;  ///< of the predicted translation
};

MotionCheckConfig read_motion_check_config(ConfigReader section);

/// A point that was followed from one left image to the next [px of the rectified pair].
struct Correspondence {
  Eigen::Vector2d previous = Eigen::Vector2d::Zero();
  Eigen::Vector2d current = Eigen::Vector2d::Zero();
  double disparity = 0.0;  ///< in the previous frame; 0: not known
};

struct CheckedMotion {
  std::vector<bool> inliers;         ///< one per correspondence
  std::vector<double> distances_px;  ///< from where the motion puts it, one per correspondence
  Pose T_current_previous;           ///< of the rectified left camera
  bool has_translation = false;      ///< false: only its rotation means anything, the predicted one
};

/// Finds the points that move as a rigid scene does (RANSAC with a fixed seed). Points with a
/// depth give the motion of the camera, rotation included, so a biased or missing prediction is
/// corrected; standstill and pure rotation are ordinary. Points without one must then lie on the
/// piece of their epipolar line that is in front of the camera. With too few depths the predicted
/// rotation is taken as it is, and only the direction of the translation is searched.
CheckedMotion check_motion(const std::vector<Correspondence>& correspondences,
                           const RectifiedStereo& stereo,
                           const Pose& predicted_T_current_previous,
                           const MotionCheckConfig& config);

}  // namespace fleetloc
