#include "shared/ros2/image_codec.hpp"

#include <cassert>
#include <utility>
#include <vector>

#include <idl/ros2/sensor_msgs.h>
#include <opencv2/imgcodecs.hpp>

#include "shared/ros2/compressed_image.hpp"
#include "shared/ros2/pixel_encoding.hpp"
#include "shared/ros2/ros2_cdr.hpp"
#include "shared/ros2/ros2_fields.hpp"

namespace fleetloc {

using sensor_msgs::msg::dds_::CompressedImage_;
using sensor_msgs::msg::dds_::Image_;

Bytes encode(const ImageMessage& message) {
  assert(message.gray.type() == CV_8UC1 && !message.gray.empty());
  const cv::Mat gray = message.gray.isContinuous() ? message.gray : message.gray.clone();
  Image_ image;
  image.header(to_ros2(message.header));
  image.height(static_cast<std::uint32_t>(gray.rows));
  image.width(static_cast<std::uint32_t>(gray.cols));
  image.encoding("mono8");
  image.is_bigendian(0);
  image.step(static_cast<std::uint32_t>(gray.cols));
  image.data(std::vector<std::uint8_t>(gray.data, gray.data + gray.total()));
  return to_cdr(image);
}

Bytes encode_as_jpeg(const ImageMessage& message, int quality) {
  assert(message.gray.type() == CV_8UC1 && !message.gray.empty());
  std::vector<std::uint8_t> file;
  cv::imencode(".jpg", message.gray, file, {cv::IMWRITE_JPEG_QUALITY, quality});
  CompressedImage_ image;
  image.header(to_ros2(message.header));
  image.format("mono8; jpeg compressed mono8");  // as image_transport has it
  image.data(std::move(file));
  return to_cdr(image);
}

Ros2Decoded<ImageMessage> decode_image(std::span<const std::uint8_t> bytes) {
  const auto image = from_ros2_cdr<Image_>(bytes);
  if (!image) return unexpected(image.error());
  if (const Ros2Validity valid = check(image->header()); !valid) return unexpected(valid.error());
  auto gray = to_gray({.width_px = image->width(),
                       .height_px = image->height(),
                       .step = image->step(),
                       .byte_order = image->is_bigendian(),
                       .data = image->data()},
                      image->encoding());
  if (!gray) return unexpected(gray.error());
  return ImageMessage{.header = from_ros2(image->header()), .gray = std::move(*gray)};
}

Ros2Decoded<ImageMessage> decode_compressed_image(std::span<const std::uint8_t> bytes) {
  const auto image = from_ros2_cdr<CompressedImage_>(bytes);
  if (!image) return unexpected(image.error());
  if (const Ros2Validity valid = check(image->header()); !valid) return unexpected(valid.error());
  auto gray = decompressed(image->data());
  if (!gray) return unexpected(gray.error());
  return ImageMessage{.header = from_ros2(image->header()), .gray = std::move(*gray)};
}

}  // namespace fleetloc
