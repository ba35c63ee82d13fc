#pragma once

#include <cmath>
#include <span>
#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <idl/ros2/geometry_msgs.h>
#include <idl/ros2/std_msgs.h>

#include "shared/geometry/pose.hpp"
#include "shared/ros2/ros2_header.hpp"
#include "shared/ros2/ros2_refusal.hpp"

/// What several messages have in common: conversions, which expect a valid field, and checks.
namespace fleetloc {

/// ROS 2 counts seconds in 31 bits: stamps before 1970 and after 2038 become the nearest that it
/// can say.
builtin_interfaces::msg::dds_::Time_ to_ros2(Timestamp stamp);
std_msgs::msg::dds_::Header_ to_ros2(const Ros2Header& header);
geometry_msgs::msg::dds_::Vector3_ to_ros2(const Eigen::Vector3d& vector);
geometry_msgs::msg::dds_::Quaternion_ to_ros2(const Eigen::Quaterniond& rotation);
geometry_msgs::msg::dds_::Pose_ to_ros2(const Pose& T);

Ros2Header from_ros2(const std_msgs::msg::dds_::Header_& header);
Eigen::Vector3d from_ros2(const geometry_msgs::msg::dds_::Vector3_& vector);
Pose from_ros2(const geometry_msgs::msg::dds_::Pose_& pose);  ///< the rotation is normalized

Ros2Validity check(const std_msgs::msg::dds_::Header_& header);
Ros2Validity check_text(const std::string& text);
Ros2Validity check_finite(std::span<const double> values);
/// Finite, and no longer than `max`.
Ros2Validity check(const geometry_msgs::msg::dds_::Vector3_& vector, double max);
Ros2Validity check(const geometry_msgs::msg::dds_::Pose_& pose);

}  // namespace fleetloc
