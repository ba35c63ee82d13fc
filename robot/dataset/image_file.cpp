#include "robot/dataset/image_file.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "shared/dataset/dataset_error.hpp"

namespace fleetloc {
namespace {

/// The decoder fills up what a JPEG file lacks. Its end marker never occurs within the picture.
bool is_jpeg_without_end(const std::vector<unsigned char>& bytes) {
  constexpr std::array<unsigned char, 2> kStart = {0xff, 0xd8};
  constexpr std::array<unsigned char, 2> kEnd = {0xff, 0xd9};
  if (bytes.size() < 2 || !std::equal(kStart.begin(), kStart.end(), bytes.begin())) return false;
  return std::search(bytes.rbegin(), bytes.rend(), kEnd.rbegin(), kEnd.rend()) == bytes.rend();
}

}  // namespace

cv::Mat read_image(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::vector<unsigned char> bytes{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) throw DatasetError(file.string() + ": cannot be read");
  if (bytes.empty()) throw DatasetError(file.string() + ": is empty");
  if (is_jpeg_without_end(bytes)) throw DatasetError(file.string() + ": is cut off");
  cv::Mat gray = cv::imdecode(bytes, cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION);
  if (gray.empty()) throw DatasetError(file.string() + ": is not an image, or damaged");
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
