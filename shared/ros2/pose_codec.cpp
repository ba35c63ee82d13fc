#include "shared/ros2/pose_codec.hpp"

#include <idl/ros2/geometry_msgs.h>
#include <idl/ros2/nav_msgs.h>
#include <idl/ros2/tf2_msgs.h>

#include "shared/ros2/pose_covariance.hpp"
#include "shared/ros2/ros2_cdr.hpp"
#include "shared/ros2/ros2_fields.hpp"

namespace fleetloc {
namespace {

using geometry_msgs::msg::dds_::PoseWithCovariance_;
using geometry_msgs::msg::dds_::PoseWithCovarianceStamped_;
using geometry_msgs::msg::dds_::TransformStamped_;

PoseWithCovariance_ pose_with_covariance(const PoseMessage& message) {
  PoseWithCovariance_ pose;
  pose.pose(to_ros2(message.T_a_b));
  pose.covariance(to_ros2_covariance(message.covariance, message.T_a_b.R));
  return pose;
}

TransformStamped_ transform_stamped(const TransformMessage& message) {
  TransformStamped_ transform;
  transform.header(to_ros2(message.header));
  transform.child_frame_id(message.child_frame);
  transform.transform().translation(to_ros2(message.T_a_b.p));
  transform.transform().rotation(to_ros2(message.T_a_b.R));
  return transform;
}

Ros2Validity check_pose_message(const PoseWithCovarianceStamped_& message) {
  if (const Ros2Validity valid = check(message.header()); !valid) return valid;
  if (const Ros2Validity valid = check(message.pose().pose()); !valid) return valid;
  return check_covariance(message.pose().covariance());
}

}  // namespace

Bytes encode(const PoseMessage& message) {
  PoseWithCovarianceStamped_ stamped;
  stamped.header(to_ros2(message.header));
  stamped.pose(pose_with_covariance(message));
  return to_cdr(stamped);
}

Bytes encode(const OdometryMessage& message) {
  nav_msgs::msg::dds_::Odometry_ odometry;
  odometry.header(to_ros2(message.pose.header));
  odometry.child_frame_id(message.child_frame);
  odometry.pose(pose_with_covariance(message.pose));
  odometry.twist().twist().linear(to_ros2(message.v_b));
  odometry.twist().twist().angular(to_ros2(message.angular_velocity));
  odometry.twist().covariance(to_ros2_twist_covariance(message.twist_covariance));
  return to_cdr(odometry);
}

Bytes encode(const std::vector<TransformMessage>& transforms) {
  tf2_msgs::msg::dds_::TFMessage_ message;
  for (const TransformMessage& transform : transforms) {
    message.transforms().push_back(transform_stamped(transform));
  }
  return to_cdr(message);
}

Ros2Decoded<PoseMessage> decode_pose(std::span<const std::uint8_t> bytes) {
  const auto message = from_ros2_cdr<PoseWithCovarianceStamped_>(bytes);
  if (!message) return unexpected(message.error());
  if (const Ros2Validity valid = check_pose_message(*message); !valid) {
    return unexpected(valid.error());
  }
  const Pose T_a_b = from_ros2(message->pose().pose());
  return PoseMessage{.header = from_ros2(message->header()),
                     .T_a_b = T_a_b,
                     .covariance = from_ros2_covariance(message->pose().covariance(), T_a_b.R)};
}

}  // namespace fleetloc
