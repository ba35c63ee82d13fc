#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "shared/geometry/pose.hpp"
#include "shared/link/channel.hpp"
#include "shared/ros2/ros2_header.hpp"
#include "shared/ros2/ros2_refusal.hpp"

namespace fleetloc {

/// geometry_msgs/PoseWithCovarianceStamped: of frame b in the header's frame a.
struct PoseMessage {
  Ros2Header header;
  Pose T_a_b;
  Matrix6d covariance = Matrix6d::Zero();  ///< ours: of the right perturbation, in frame b
};

/// nav_msgs/Odometry: of the child's frame b in the header's frame a.
struct OdometryMessage {
  PoseMessage pose;
  std::string child_frame;
  Eigen::Vector3d v_b = Eigen::Vector3d::Zero();               ///< in frame b [m/s]
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< in frame b [rad/s]
  Matrix6d twist_covariance = Matrix6d::Zero();                ///< [angular, linear], in frame b
};

/// geometry_msgs/TransformStamped.
struct TransformMessage {
  Ros2Header header;  ///< frame a
  std::string child_frame;
  Pose T_a_b;
};

Bytes encode(const PoseMessage& message);
Bytes encode(const OdometryMessage& message);
/// tf2_msgs/TFMessage.
Bytes encode(const std::vector<TransformMessage>& transforms);

/// Rotation within 1 % of unit length, covariance positive semi-definite; all of it zero is left
/// so: it says "unknown". Never throws.
Ros2Decoded<PoseMessage> decode_pose(std::span<const std::uint8_t> bytes);

}  // namespace fleetloc
