#pragma once

#include <optional>
#include <string>

#include "shared/core/ids.hpp"
#include "shared/core/time.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/model/camera.hpp"

namespace fleetloc {

/// How submaps are sent: as the paper has it, or one datagram at a time.
enum class SubmapEncoding { kFull, kCompact };

/// Estimate of T_map_odom when the robot was at `p_odom`; the odometry's drift since then adds to
/// its covariance.
struct MapOdomEstimate {
  Pose T_map_odom;
  Matrix6d covariance = Matrix6d::Identity();        ///< right perturbation of T_map_odom
  Eigen::Vector3d p_odom = Eigen::Vector3d::Zero();  ///< of the body at that time [m]
};

/// Where in the map a robot began: in a part that the map has a name for, or within a circle.
struct StartRegion {
  std::string name = {};                                 ///< empty: the circle
  Eigen::Vector2d center_map = Eigen::Vector2d::Zero();  ///< [m]
  double radius_m = 0.0;
  Eigen::Vector3d p_odom = Eigen::Vector3d::Zero();  ///< of the body when it was there [m]
};

/// What a localizer needs before the first submap of a session.
struct RobotSession {
  RobotId robot;
  SessionNumber
      session{};  ///< increases at every reset of the robot's odometry, and when it is placed
  Timestamp start_stamp;  ///< when the robot's program started; a later one replaces the session
  std::string localizer;  ///< the chosen one
  Incarnation incarnation{};  ///< of that localizer; others ignore it
  SubmapEncoding encoding = SubmapEncoding::kFull;
  RectifiedStereo stereo;
  std::optional<MapOdomEstimate> start;    ///< without it the robot is searched for,
  std::optional<StartRegion> region = {};  ///< from there, if this is known; not beside a start
};

/// Status of a localizer, for all robots.
struct LocalizerStatus {
  std::string localizer;
  Incarnation incarnation{};  ///< a new one has no sessions
  MapHash map_hash{};
  int sessions = 0;
  double load = 0.0;       ///< share of its worker time in use, 0..1
  bool accepting = false;  ///< takes robots that it does not serve yet
  bool draining = false;   ///< is about to end: its robots should leave
};

}  // namespace fleetloc
