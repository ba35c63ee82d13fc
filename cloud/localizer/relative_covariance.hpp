#pragma once

#include <Eigen/Core>

#include "cloud/localizer/window_system.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// Joint covariance of the window's poses T_map_body from one keyframe on, right perturbations, and
/// of what it makes of relative quantities (paper, eq. 9 and 10).
class PoseCovariances {
 public:
  /// @param covariance  6 rows and columns for each keyframe
  /// @param first  the window's index of the oldest of them
  PoseCovariances(Eigen::MatrixXd covariance, int first);

  /// Of T_a_b, right perturbation: that is d_b - Ad(T_a_b)^-1 d_a.
  [[nodiscard]] Matrix6d of_relative_pose(int a, int b, const Pose& T_a_b) const;

  /// Of p_anchor = T_map_anchor^-1 p_map, with the newest keyframe as the anchor [m^2].
  /// @param H  information of p_map, given the poses [1/m^2]
  /// @param T_map_anchor  of the newest keyframe
  [[nodiscard]] Eigen::Matrix3d of_anchored_landmark(const WindowSystem::Landmark& landmark,
                                                     const Eigen::Matrix3d& H,
                                                     const Pose& T_map_anchor) const;

 private:
  [[nodiscard]] Eigen::Index at(int keyframe) const {
    return Eigen::Index{6} * (keyframe - first_);
  }
  [[nodiscard]] Matrix6d block(int a, int b) const { return covariance_.block<6, 6>(at(a), at(b)); }

  Eigen::MatrixXd covariance_;
  int first_;
};

}  // namespace fleetloc
