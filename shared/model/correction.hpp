#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "shared/core/ids.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// The cloud's corrections of the robot's window (paper, eq. 9 and 10) as relative quantities,
/// which stay valid when `odom` is revised. All information is only what the laser map has added:
/// the rest is the robot's own measurements.
struct Correction {
  /// The error is Log(T_from_to^-1 * T_odom_from^-1 * T_odom_to), [rotation rad, translation m].
  struct RelativePose {
    KeyframeId from{};
    KeyframeId to{};  ///< the next keyframe of the cloud's window
    Pose T_from_to;
    Matrix6d information = Matrix6d::Zero();  ///< positive semi-definite
  };
  /// The error is T_odom_anchor^-1 * p_odom - p_anchor [m].
  struct Landmark {
    LandmarkId id{};
    Eigen::Vector3d p_anchor = Eigen::Vector3d::Zero();     ///< in the anchor's body frame [m]
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< positive semi-definite [1/m^2]
  };

  RobotId robot;
  SessionNumber session{};
  std::string localizer;
  Incarnation incarnation{};
  KeyframeId anchor{};                       ///< newest keyframe of the answer that this belongs to
  std::vector<RelativePose> relative_poses;  ///< strictly increasing by `to`
  std::vector<Landmark> landmarks;           ///< strictly increasing by id
};

}  // namespace fleetloc
