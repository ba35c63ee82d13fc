#include "shared/ros2/pixel_encoding.hpp"

#include <array>

#include <opencv2/imgproc.hpp>

namespace fleetloc {
namespace {

constexpr int kNoConversion = -1;

struct PixelEncoding {
  std::string_view name;
  int type;        // of cv::Mat
  int conversion;  // to gray
};

// OpenCV names a Bayer pattern by the second row's second and third pixel, ROS by the first ones.
constexpr std::array kEncodings{
    PixelEncoding{"mono8", CV_8UC1, kNoConversion},
    PixelEncoding{"8UC1", CV_8UC1, kNoConversion},
    PixelEncoding{"mono16", CV_16UC1, kNoConversion},
    PixelEncoding{"16UC1", CV_16UC1, kNoConversion},
    PixelEncoding{"rgb8", CV_8UC3, cv::COLOR_RGB2GRAY},
    PixelEncoding{"bgr8", CV_8UC3, cv::COLOR_BGR2GRAY},
    PixelEncoding{"bayer_rggb8", CV_8UC1, cv::COLOR_BayerBG2GRAY},
    PixelEncoding{"bayer_bggr8", CV_8UC1, cv::COLOR_BayerRG2GRAY},
    PixelEncoding{"bayer_gbrg8", CV_8UC1, cv::COLOR_BayerGR2GRAY},
    PixelEncoding{"bayer_grbg8", CV_8UC1, cv::COLOR_BayerGB2GRAY},
};

const PixelEncoding* encoding_named(std::string_view name) {
  for (const PixelEncoding& encoding : kEncodings) {
    if (encoding.name == name) return &encoding;
  }
  return nullptr;
}

Ros2Validity check_image(const RawImage& image, const PixelEncoding& encoding) {
  const std::uint64_t width = image.width_px;
  const std::uint64_t height = image.height_px;
  if (width == 0 || height == 0) return unexpected(Ros2Refusal::kEmptyImage);
  // Also each side, so that it fits the int of OpenCV.
  const bool is_too_large =
      width > kMaxPixels || height > kMaxPixels || width * height > kMaxPixels;
  if (is_too_large) return unexpected(Ros2Refusal::kTooManyPixels);
  if (image.byte_order > 1) return unexpected(Ros2Refusal::kWrongOrder);
  const auto pixel_bytes = static_cast<std::uint64_t>(CV_ELEM_SIZE(encoding.type));
  if (image.step < width * pixel_bytes) return unexpected(Ros2Refusal::kWrongStep);
  if (image.data.size() != image.step * height) return unexpected(Ros2Refusal::kWrongLength);
  return {};
}

/// Byte by byte: a row may begin at an odd address, and OpenCV's pixels may not.
cv::Mat upper_bytes(const RawImage& image) {
  const std::size_t upper = image.byte_order == 1 ? 0 : 1;
  cv::Mat gray(static_cast<int>(image.height_px), static_cast<int>(image.width_px), CV_8UC1);
  for (int y = 0; y < gray.rows; ++y) {
    const std::size_t row = std::size_t{image.step} * static_cast<std::size_t>(y) + upper;
    for (int x = 0; x < gray.cols; ++x) {
      gray.at<std::uint8_t>(y, x) = image.data[row + 2 * static_cast<std::size_t>(x)];
    }
  }
  return gray;
}

}  // namespace

Ros2Decoded<cv::Mat> to_gray(const RawImage& image, std::string_view encoding) {
  const PixelEncoding* known = encoding_named(encoding);
  if (known == nullptr) return unexpected(Ros2Refusal::kUnknownEncoding);
  if (const Ros2Validity valid = check_image(image, *known); !valid)
    return unexpected(valid.error());
  try {
    if (known->type == CV_16UC1) return upper_bytes(image);
    // Only read: what OpenCV takes is not const.
    auto* data = const_cast<std::uint8_t*>(image.data.data());
    const cv::Mat view(static_cast<int>(image.height_px),
                       static_cast<int>(image.width_px),
                       known->type,
                       data,
                       image.step);
    if (known->conversion == kNoConversion) return view.clone();
    cv::Mat gray;
    cv::cvtColor(view, gray, known->conversion);
    return gray;
  } catch (const std::exception&) {  // OpenCV's, and lack of memory
    return unexpected(Ros2Refusal::kEmptyImage);
  }
}

}  // namespace fleetloc
