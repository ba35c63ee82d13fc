#pragma once

#include "robot/vio/sliding_window.hpp"
#include "shared/model/pose_estimate.hpp"
#include "shared/model/session.hpp"

namespace fleetloc {

/// Moves a new start of the odometry, in yaw and position, to where dead reckoning saw the robot at
/// the stamp of the oldest keyframe: odom goes on, as uncertain as that pose was.
void continue_from(const PoseEstimate& dead_reckoned, Initialization& initialization);

/// T_map_odom after continue_from, by a dead-reckoned pose that has a map pose; T_odom_body is the
/// new odometry's of the same stamp.
MapOdomEstimate continued_alignment(const PoseEstimate& dead_reckoned, const Pose& T_odom_body);

/// The same for an odometry that never had a map pose: its start pose, grown by the drift since.
MapOdomEstimate continued_start(const MapOdomEstimate& start, const PoseEstimate& dead_reckoned);

}  // namespace fleetloc
