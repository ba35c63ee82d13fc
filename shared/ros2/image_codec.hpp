#pragma once

#include <cstdint>
#include <span>

#include <opencv2/core/mat.hpp>

#include "shared/link/channel.hpp"
#include "shared/ros2/ros2_header.hpp"
#include "shared/ros2/ros2_refusal.hpp"

namespace fleetloc {

/// sensor_msgs/Image or CompressedImage, decoded.
struct ImageMessage {
  Ros2Header header;  ///< its frame is that of the camera
  cv::Mat gray;       ///< 8 bit
};

/// As Image in mono8.
/// @param message  a gray image that is not empty
Bytes encode(const ImageMessage& message);

/// As CompressedImage in JPEG.
/// @param message  a gray image that is not empty
/// @param quality  0 to 100
Bytes encode_as_jpeg(const ImageMessage& message, int quality);

/// At most 64 million pixels in an encoding of to_gray(). Never throws.
Ros2Decoded<ImageMessage> decode_image(std::span<const std::uint8_t> bytes);

/// JPEG or PNG, whatever the message calls it. Never throws.
Ros2Decoded<ImageMessage> decode_compressed_image(std::span<const std::uint8_t> bytes);

}  // namespace fleetloc
