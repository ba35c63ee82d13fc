#include "shared/ros2/compressed_image.hpp"

#include <opencv2/imgcodecs.hpp>

#include "shared/core/image_pixels.hpp"
#include "shared/core/jpeg_end.hpp"

namespace fleetloc {

Ros2Decoded<cv::Mat> decompressed(const std::vector<std::uint8_t>& file) {
  if (!is_jpeg(file) && !is_png(file)) return unexpected(Ros2Refusal::kUnknownEncoding);
  const auto pixels = image_pixels(file);
  const bool is_whole = !is_jpeg(file) || has_jpeg_end(file);
  if (!pixels || !is_whole) return unexpected(Ros2Refusal::kDamagedImage);
  if (*pixels == 0) return unexpected(Ros2Refusal::kEmptyImage);
  if (*pixels > kMaxPixels) return unexpected(Ros2Refusal::kTooManyPixels);
  try {
    cv::Mat gray = cv::imdecode(file, cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION);
    if (gray.empty()) return unexpected(Ros2Refusal::kDamagedImage);
    return gray;
  } catch (const std::exception&) {  // OpenCV's, and lack of memory
    return unexpected(Ros2Refusal::kDamagedImage);
  }
}

}  // namespace fleetloc
