#include "robot/node/ros2_poses.hpp"

namespace fleetloc {
namespace {

// A right perturbation of T_a_body becomes one of T_a_base by the adjoint of T_base_body.
PoseMessage base_pose(const Ros2Header& header,
                      const Pose& T_a_body,
                      const Matrix6d& covariance,
                      const Pose& T_base_body) {
  const Matrix6d A = adjoint(T_base_body);
  return {.header = header,
          .T_a_b = T_a_body * inverse(T_base_body),
          .covariance = A * covariance * A.transpose()};
}

}  // namespace

OdometryMessage odometry_message(const PoseEstimate& pose, const RosFrames& frames) {
  const Pose& T_base_body = frames.T_base_imu;
  const Eigen::Vector3d p_body_base = inverse(T_base_body).p;
  const Eigen::Vector3d v_body = pose.T_odom_body.R.conjugate() * pose.v_odom;
  const Eigen::Vector3d v_base_origin = v_body + pose.angular_velocity.cross(p_body_base);
  return {.pose = base_pose({.stamp = pose.stamp, .frame = frames.odom},
                            pose.T_odom_body,
                            pose.covariance_odom,
                            T_base_body),
          .child_frame = frames.base,
          .v_b = T_base_body.R * v_base_origin,
          .angular_velocity = T_base_body.R * pose.angular_velocity};
}

PoseMessage map_pose_message(const PoseEstimate& pose, const RosFrames& frames) {
  return base_pose({.stamp = pose.stamp, .frame = frames.map},
                   pose.T_map_body.value(),
                   pose.covariance_map,
                   frames.T_base_imu);
}

std::optional<GivenPose> given_pose(const PoseMessage& message, const RosFrames& frames) {
  if (message.header.frame != frames.map) return std::nullopt;
  const Pose& T_base_body = frames.T_base_imu;
  const Matrix6d A = adjoint(inverse(T_base_body));
  return GivenPose{.stamp = message.header.stamp,
                   .T_map_body = message.T_a_b * T_base_body,
                   .covariance = A * message.covariance * A.transpose()};
}

TransformMessage odom_base_transform(const PoseEstimate& pose, const RosFrames& frames) {
  return {.header = {.stamp = pose.stamp, .frame = frames.odom},
          .child_frame = frames.base,
          .T_a_b = pose.T_odom_body * inverse(frames.T_base_imu)};
}

TransformMessage map_odom_transform(const PoseEstimate& pose, const RosFrames& frames) {
  return {.header = {.stamp = pose.stamp, .frame = frames.map},
          .child_frame = frames.odom,
          .T_a_b = pose.T_map_body.value() * inverse(pose.T_odom_body)};
}

}  // namespace fleetloc
