#include "robot/dataset/image_file.hpp"

#include <fstream>
#include <iterator>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "shared/core/image_pixels.hpp"
#include "shared/core/jpeg_end.hpp"
#include "shared/dataset/dataset_error.hpp"

namespace fleetloc {
namespace {

/// Empty if it cannot be decoded.
cv::Mat decoded(const std::vector<unsigned char>& bytes) {
  try {
    return cv::imdecode(bytes, cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {  // of sizes that contradict each other
    return {};
  }
}

}  // namespace

cv::Mat read_image(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::vector<unsigned char> bytes{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) throw DatasetError(file.string() + ": cannot be read");
  if (bytes.empty()) throw DatasetError(file.string() + ": is empty");
  if (is_jpeg(bytes) && !has_jpeg_end(bytes)) throw DatasetError(file.string() + ": is cut off");
  const auto pixels = image_pixels(bytes);
  if (pixels && *pixels > kMaxPixels) {
    throw DatasetError(file.string() + ": has more than 64 million pixels");
  }
  cv::Mat gray = pixels ? decoded(bytes) : cv::Mat();
  if (gray.empty()) throw DatasetError(file.string() + ": is neither a JPEG nor a PNG, or damaged");
  return gray;
}

void write_image(const std::filesystem::path& file, const cv::Mat& gray, int jpeg_quality) {
  bool written = false;
  try {
    written = cv::imwrite(file.string(), gray, {cv::IMWRITE_JPEG_QUALITY, jpeg_quality});
  } catch (const cv::Exception&) {
    written = false;
  }
  if (!written) throw DatasetError(file.string() + ": cannot be written");
}

}  // namespace fleetloc
