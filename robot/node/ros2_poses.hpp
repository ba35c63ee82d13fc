#pragma once

#include <optional>

#include "robot/live/sensors_config.hpp"
#include "robot/sensors/given_pose.hpp"
#include "shared/model/pose_estimate.hpp"
#include "shared/ros2/pose_codec.hpp"

namespace fleetloc {

// What ROS 2 is told of a pose (REP 105): all of the base frame, whose origin and axes are those of
// RosFrames::T_base_imu. Covariances are moved with it.

/// Pose in `odom`; velocities of the base's origin in the base's axes, their covariance unknown
/// (zero).
OdometryMessage odometry_message(const PoseEstimate& pose, const RosFrames& frames);

/// Pose in `map`.
/// @param pose  with T_map_body
PoseMessage map_pose_message(const PoseEstimate& pose, const RosFrames& frames);

/// Where somebody says that the robot is. Nothing if the pose is not in the frame `map`.
std::optional<GivenPose> given_pose(const PoseMessage& message, const RosFrames& frames);

/// odom -> base.
TransformMessage odom_base_transform(const PoseEstimate& pose, const RosFrames& frames);

/// map -> odom.
/// @param pose  with T_map_body
TransformMessage map_odom_transform(const PoseEstimate& pose, const RosFrames& frames);

}  // namespace fleetloc
