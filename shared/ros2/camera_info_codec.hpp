#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "shared/link/channel.hpp"
#include "shared/model/camera.hpp"
#include "shared/ros2/ros2_header.hpp"
#include "shared/ros2/ros2_refusal.hpp"

namespace fleetloc {

/// sensor_msgs/CameraInfo. Matrices are row-major.
struct CameraInfoMessage {
  /// Of the image that was calibrated; all zero: the whole of it.
  struct Region {
    std::uint32_t x_px = 0;
    std::uint32_t y_px = 0;
    std::uint32_t width_px = 0;
    std::uint32_t height_px = 0;
  };

  Ros2Header header;
  int width_px = 0;
  int height_px = 0;
  std::string distortion_model;      ///< e.g. plumb_bob, equidistant
  std::vector<double> coefficients;  ///< D, at most 14
  std::array<double, 9> K{};         ///< intrinsics of the raw image
  std::array<double, 9> R{};         ///< from the camera to the rectified one
  std::array<double, 12> P{};        ///< of the rectified image; P[3] = -fx * baseline_m
  std::uint32_t binning_x = 1;
  std::uint32_t binning_y = 1;
  Region region;
};

/// A camera that is not rectified: P is K, R is the identity.
CameraInfoMessage camera_info(const Camera& camera, const Ros2Header& header);

/// Left and right camera of a pair, without headers. Images are as they were taken: K and D hold; R
/// and P are of a pair that is rectified().
std::array<CameraInfoMessage, 2> camera_info(const StereoCalibration& pair);

Bytes encode(const CameraInfoMessage& message);

/// Finite numbers, a size of at most 64 million pixels, focal lengths above zero. Whether R and P
/// are of a rectified pair is for the caller to see. Never throws.
Ros2Decoded<CameraInfoMessage> decode_camera_info(std::span<const std::uint8_t> bytes);

}  // namespace fleetloc
