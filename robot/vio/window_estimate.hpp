#pragma once

#include <map>
#include <vector>

#include "robot/inertial/inertial_window.hpp"
#include "shared/core/ids.hpp"
#include "shared/model/inertial.hpp"
#include "shared/model/observation.hpp"

namespace fleetloc {

struct WindowKeyframe {
  KeyframeId id{};
  Timestamp stamp;
  NavState state;
  std::vector<StereoObservation> observations;  ///< without those found to be outliers
  double tilt_sigma = 0.0;                      ///< roll and pitch, one axis [rad]
};

struct LandmarkEstimate {
  Eigen::Vector3d p_odom = Eigen::Vector3d::Zero();
  int observations = 0;  ///< keyframes of the window that see it
  /// Sigma of depth / depth, from the newest observing keyframe.
  double relative_depth_sigma = 0.0;
};

/// Summary of one optimization of the window.
struct WindowDiagnostics {
  double initial_cost = 0.0;  ///< 0.5 * robust squared residuals
  double final_cost = 0.0;
  int iterations = 0;
  bool converged = false;       ///< to a usable solution; false: trust nothing of this estimate
  int observations = 0;         ///< that took part
  int outliers_removed = 0;     ///< observations that failed the chi-square test afterwards
  int corrections_applied = 0;  ///< of the cloud, landmarks and relative poses
  int corrections_ignored = 0;  ///< likewise: not of this window, or not wanted
};

/// The sliding window after an optimization.
struct WindowEstimate {
  std::vector<WindowKeyframe> keyframes;  ///< oldest first
  InertialWindow inertial;                ///< of the same keyframes
  std::map<LandmarkId, LandmarkEstimate> landmarks;
  /// Of the newest state, in odom, with the drift since the start; without the cloud's corrections.
  Matrix15d covariance = Matrix15d::Zero();
  WindowDiagnostics diagnostics;
};

}  // namespace fleetloc
