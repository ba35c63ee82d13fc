#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include <opencv2/core/mat.hpp>

#include "shared/core/image_pixels.hpp"
#include "shared/ros2/ros2_refusal.hpp"

namespace fleetloc {

/// An image as it stands in a message.
struct RawImage {
  std::uint32_t width_px = 0;
  std::uint32_t height_px = 0;
  std::uint32_t step = 0;       ///< bytes of a row
  std::uint8_t byte_order = 0;  ///< 1: big endian
  std::span<const std::uint8_t> data;
};

/// To 8 bit gray; of 16 bit the upper 8. Copies, and never throws.
/// @param encoding  mono8, 8UC1, mono16, 16UC1, rgb8, bgr8, bayer_{rggb,bggr,gbrg,grbg}8
Ros2Decoded<cv::Mat> to_gray(const RawImage& image, std::string_view encoding);

}  // namespace fleetloc
