#pragma once

#include <optional>

#include <Eigen/Core>

#include "cloud/localizer/degeneracy.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/core/ids.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// A pose in the map with the covariance of its right perturbation.
struct PoseWithCovariance {
  Pose T_map_body;
  Matrix6d covariance = Matrix6d::Identity();
};

/// Drift of the robot's odometry: standard deviations per metre travelled.
struct DriftConfig {
  double translation_m_per_m;
  double rotation_rad_per_m;
};

/// The pose in the map from which odometry is dead-reckoned: the start pose until the session has
/// been localized, then that of the newest localized keyframe.
struct PoseAnchor {
  std::optional<KeyframeId> keyframe;  ///< none: where the start pose was known
  Pose T_odom_body;          ///< the odometry there, as it was when the keyframe was localized
  double travelled_m = 0.0;  ///< path length of the odometry until then
  PoseWithCovariance estimate;

  /// Dead-reckoned to a later (or earlier) pose of the same session, at path length
  /// `travelled_m_later` [m]. The drift grows with the path length, also around a closed loop.
  [[nodiscard]] PoseWithCovariance at(const Pose& T_odom_later,
                                      double travelled_m_later,
                                      const DriftConfig& drift) const;
};

/// Information of a pose prior that holds only the `weak` directions of a motion of the window,
/// with the covariance of `estimate` plus `min_sigma_m` squared.
Matrix6d information_along(const Eigen::Matrix<double, 6, Eigen::Dynamic>& weak,
                           const WindowMotion& motion,
                           const PoseWithCovariance& estimate,
                           double min_sigma_m);

/// Covariance of `result`, raised along the `weak` directions to at least `min_covariance`.
Matrix6d widened_along(const Eigen::Matrix<double, 6, Eigen::Dynamic>& weak,
                       const WindowMotion& motion,
                       const PoseWithCovariance& result,
                       const Matrix6d& min_covariance);

DriftConfig read_drift_config(ConfigReader section);

}  // namespace fleetloc
