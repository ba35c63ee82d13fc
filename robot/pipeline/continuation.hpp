#pragma once

#include "robot/vio/sliding_window.hpp"
#include "shared/model/pose_estimate.hpp"
#include "shared/model/session.hpp"

namespace fleetloc {

/// Transforms a new initialization in yaw and position so that its oldest keyframe is at the
/// dead-reckoned pose: odom stays continuous, with that pose's uncertainty as drift.
void continue_from(const PoseEstimate& dead_reckoned, Initialization& initialization);

/// T_map_odom after continue_from, from a dead-reckoned estimate with a map pose; T_odom_body is
/// the new odometry's at the same stamp.
MapOdomEstimate continued_alignment(const PoseEstimate& dead_reckoned, const Pose& T_odom_body);

/// The same without a map pose: the session's start, with the drift since added to its covariance.
MapOdomEstimate continued_start(const MapOdomEstimate& start, const PoseEstimate& dead_reckoned);

}  // namespace fleetloc
