#pragma once

#include <optional>
#include <string>

#include "shared/core/ids.hpp"
#include "shared/core/time.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/model/camera.hpp"

namespace fleetloc {

enum class SubmapEncoding { kFull, kDelta };

/// Where `odom` lies in the map, as the robot knew it at some place of its way: from there on the
/// odometry's drift adds to it.
struct MapOdomEstimate {
  Pose T_map_odom;
  Matrix6d covariance = Matrix6d::Identity();        ///< right perturbation of T_map_odom
  Eigen::Vector3d p_odom = Eigen::Vector3d::Zero();  ///< of the body at that place [m]
};

/// What a localizer must know before the first submap of a session.
struct RobotSession {
  RobotId robot;
  SessionNumber session{};  ///< increases at every reset of the robot's odometry
  Timestamp start_stamp;    ///< when the robot's program started; a later one replaces the session
  std::string localizer;    ///< the chosen one
  Incarnation incarnation{};  ///< of that localizer: another start of it is not meant
  SubmapEncoding encoding = SubmapEncoding::kFull;
  RectifiedStereo stereo;
  std::optional<MapOdomEstimate> start;  ///< without it the session cannot be localized yet
};

/// What a localizer says of itself.
struct LocalizerStatus {
  std::string localizer;
  Incarnation incarnation{};  ///< a new one has forgotten everything
  MapHash map_hash{};
  int sessions = 0;
  double load = 0.0;  ///< share of its worker time in use, 0..1
  bool accepting = false;
};

}  // namespace fleetloc
