#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "shared/core/time.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

// What cyclone_recorder and cyclone_driver have written. Times of one clock: seconds since the
// boot.

struct RecordedPose {
  double received_s = 0.0;
  Timestamp stamp;
  std::string frame;
  std::string child_frame;
  Pose T_frame_child;
  std::array<double, 36> covariance{};  ///< row-major, as ROS has it: position first; 0 in tf
};

/// odometry.csv, map_pose.csv or tf.csv.
std::vector<RecordedPose> recorded_poses(const std::filesystem::path& file);

struct RecordedImage {
  Timestamp stamp;
  std::string frame;
  std::string topic;
  std::string format;  ///< width,height,step,encoding,bytes
  std::uint64_t fnv1a = 0;
};

/// images.csv.
std::vector<RecordedImage> recorded_images(const std::filesystem::path& file);

/// Angular velocity [rad/s] and specific force [m/s^2] of imu.csv.
std::map<Timestamp, std::array<double, 6>> recorded_imu(const std::filesystem::path& file);

/// When each pair of images was published [s since the boot]: published.csv.
std::map<Timestamp, double> publication_times(const std::filesystem::path& file);

}  // namespace fleetloc
