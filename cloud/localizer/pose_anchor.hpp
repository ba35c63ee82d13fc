#pragma once

#include <optional>

#include <Eigen/Core>

#include "cloud/localizer/degeneracy.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/core/ids.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// A pose in the map with the covariance of its right perturbation.
struct PoseBelief {
  Pose T_map_body;
  Matrix6d covariance = Matrix6d::Identity();
};

/// How fast the robot's odometry loses its way: standard deviations per metre of the path.
struct DriftConfig {
  double translation_m_per_m;
  double rotation_rad_per_m;
};

/// What is known about the place of `odom` in the map apart from the window's matches: the start
/// pose until the session has been localized, then the newest localized keyframe.
struct PoseAnchor {
  std::optional<KeyframeId> keyframe;  ///< none: where the start pose was known
  Pose T_odom_body;                    ///< there; of that keyframe, when it was localized
  double travelled_m = 0.0;            ///< of the odometry until then
  PoseBelief belief;

  /// Carried by odometry to a later (or earlier) pose of the same session, `travelled_m_later` from
  /// where the path begins. The drift grows with the path: a loop that comes back is no shorter for
  /// it.
  [[nodiscard]] PoseBelief at(const Pose& T_odom_later,
                              double travelled_m_later,
                              const DriftConfig& drift) const;
};

/// The information of `belief`, restricted to the `weak` directions of a motion of the window, for
/// a prior on its pose. `min_sigma_m` bounds how hard it may hold.
Matrix6d information_along(const Eigen::Matrix<double, 6, Eigen::Dynamic>& weak,
                           const WindowMotion& motion,
                           const PoseBelief& belief,
                           double min_sigma_m);

/// `covariance` of T_map_body, made no smaller along the `weak` directions than `least` is.
Matrix6d widened_along(const Eigen::Matrix<double, 6, Eigen::Dynamic>& weak,
                       const WindowMotion& motion,
                       const PoseBelief& result,
                       const Matrix6d& min_covariance);

DriftConfig read_drift_config(ConfigReader section);

}  // namespace fleetloc
