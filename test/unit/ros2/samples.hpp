#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <idl/ros2/sensor_msgs.h>

#include "shared/geometry/so3.hpp"
#include "shared/ros2/camera_info_codec.hpp"
#include "shared/ros2/image_codec.hpp"
#include "shared/ros2/imu_codec.hpp"
#include "shared/ros2/pose_codec.hpp"
#include "shared/ros2/ros2_cdr.hpp"
#include "shared/ros2/ros2_fields.hpp"

namespace fleetloc {

inline Ros2Header some_header() {
  return {.stamp = Timestamp(Duration(1'403'636'579'763'555'584)), .frame = "map"};
}

inline Pose some_pose() {
  return {exp_so3({0.6, -1.1, 0.4}), {3.5, -20.25, 1.75}};
}

/// Full, symmetric, positive definite, different in every entry.
inline Matrix6d some_covariance() {
  Matrix6d root = Matrix6d::Zero();
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) root(i, j) = 0.02 * (1 + i) / (1.0 + 2.0 * (j - i) + 0.3 * j);
  }
  return root.transpose() * root;
}

inline PoseMessage some_pose_message() {
  return {.header = some_header(), .T_a_b = some_pose(), .covariance = some_covariance()};
}

inline ImuMessage some_imu() {
  return {.frame = "imu",
          .sample = {.stamp = some_header().stamp,
                     .angular_velocity = {0.1, -0.2, 0.3},
                     .specific_force = {-1.5, 0.25, 9.75}}};
}

/// Every pixel differs from its neighbors.
inline ImageMessage some_image(int width = 7, int height = 5) {
  ImageMessage message{.header = some_header(), .gray = cv::Mat(height, width, CV_8UC1)};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      message.gray.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(37 * y + 11 * x);
    }
  }
  return message;
}

inline CameraInfoMessage some_camera_info() {
  CameraInfoMessage info = camera_info({.width_px = 752,
                                        .height_px = 480,
                                        .focal_px = {458.5, 457.25},
                                        .center_px = {367.0, 248.5},
                                        .distortion = Camera::Distortion::kRadialTangential,
                                        .coefficients = {-0.28, 0.07, 0.0002, 0.00002}},
                                       some_header());
  info.binning_x = 2;
  info.binning_y = 3;
  info.region = {.x_px = 1, .y_px = 2, .width_px = 30, .height_px = 40};
  return info;
}

/// An image of another encoding, as another program would send it.
inline sensor_msgs::msg::dds_::Image_ raw_image(std::uint32_t width,
                                                std::uint32_t height,
                                                const std::string& encoding,
                                                std::vector<std::uint8_t> data) {
  sensor_msgs::msg::dds_::Image_ image;
  image.header(to_ros2(some_header()));
  image.width(width);
  image.height(height);
  image.encoding(encoding);
  image.step(static_cast<std::uint32_t>(data.size()) / height);
  image.data(std::move(data));
  return image;
}

template <typename T>
void expect_refused(const Ros2Decoded<T>& decoded, std::string_view reason) {
  ASSERT_FALSE(decoded.has_value()) << "accepted, and not refused as " << reason;
  EXPECT_EQ(name(decoded.error()), reason);
}

inline bool same_pixels(const cv::Mat& a, const cv::Mat& b) {
  if (a.size() != b.size() || a.type() != b.type()) return false;
  for (int y = 0; y < a.rows; ++y) {
    if (!std::equal(a.ptr(y), a.ptr(y) + a.cols * static_cast<int>(a.elemSize()), b.ptr(y))) {
      return false;
    }
  }
  return true;
}

}  // namespace fleetloc
