#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "shared/ros2/ros2_refusal.hpp"

namespace fleetloc {

/// A JPEG or PNG file to 8 bit gray, as it lies in memory: a note on the camera's orientation is
/// not obeyed. Its size is read before anything is decoded. Never throws.
Ros2Decoded<cv::Mat> decompressed(const std::vector<std::uint8_t>& file);

}  // namespace fleetloc
