#pragma once

/// Names under which ROS 2 registers the types of idl/ros2/ with DDS.
namespace fleetloc::ros2_type {

inline constexpr const char* kImage = "sensor_msgs::msg::dds_::Image_";
inline constexpr const char* kCompressedImage = "sensor_msgs::msg::dds_::CompressedImage_";
inline constexpr const char* kCameraInfo = "sensor_msgs::msg::dds_::CameraInfo_";
inline constexpr const char* kImu = "sensor_msgs::msg::dds_::Imu_";
inline constexpr const char* kPointCloud = "sensor_msgs::msg::dds_::PointCloud2_";
inline constexpr const char* kOdometry = "nav_msgs::msg::dds_::Odometry_";
inline constexpr const char* kPoseWithCovariance =
    "geometry_msgs::msg::dds_::PoseWithCovarianceStamped_";
inline constexpr const char* kTransforms = "tf2_msgs::msg::dds_::TFMessage_";
inline constexpr const char* kDiagnostics = "diagnostic_msgs::msg::dds_::DiagnosticArray_";

}  // namespace fleetloc::ros2_type
