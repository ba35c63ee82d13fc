#include "shared/ros2/compressed_image.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <span>

#include <opencv2/imgcodecs.hpp>

#include "shared/core/jpeg_end.hpp"
#include "shared/ros2/pixel_encoding.hpp"

namespace fleetloc {
namespace {

using File = std::span<const std::uint8_t>;

constexpr std::array<std::uint8_t, 3> kJpeg{0xff, 0xd8, 0xff};
constexpr std::array<std::uint8_t, 8> kPng{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};

bool begins_with(File file, File begin) {
  return file.size() >= begin.size() && std::ranges::equal(file.first(begin.size()), begin);
}

std::uint64_t big_endian(File bytes) {
  std::uint64_t value = 0;
  for (const std::uint8_t byte : bytes) value = 256 * value + byte;
  return value;
}

/// Width times height, from the chunk that a PNG begins with.
std::optional<std::uint64_t> png_pixels(File file) {
  constexpr std::size_t kWidth = 16;
  constexpr std::size_t kHeight = 20;
  if (file.size() < kHeight + 4) return std::nullopt;
  return big_endian(file.subspan(kWidth, 4)) * big_endian(file.subspan(kHeight, 4));
}

// Markers of frames: C0 to CF, but for those of tables and extensions.
bool is_frame(std::uint8_t marker) {
  return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
}

/// Width times height, from the first frame of a JPEG (ITU T.81, B.2.2).
std::optional<std::uint64_t> jpeg_pixels(File file) {
  constexpr std::size_t kFrameHeader = 9;  // marker, length, precision, height, width
  std::size_t at = 2;
  while (at + kFrameHeader <= file.size()) {
    if (file[at] != 0xff) return std::nullopt;
    const std::uint8_t marker = file[at + 1];
    if (marker == 0xff) {  // filled up
      ++at;
      continue;
    }
    if (is_frame(marker)) {
      return big_endian(file.subspan(at + 5, 2)) * big_endian(file.subspan(at + 7, 2));
    }
    at += 2 + big_endian(file.subspan(at + 2, 2));
  }
  return std::nullopt;
}

}  // namespace

Ros2Decoded<cv::Mat> decompressed(const std::vector<std::uint8_t>& file) {
  const bool is_jpeg = begins_with(file, kJpeg);
  if (!is_jpeg && !begins_with(file, kPng)) return unexpected(Ros2Refusal::kUnknownEncoding);
  const auto pixels = is_jpeg ? jpeg_pixels(file) : png_pixels(file);
  if (!pixels || (is_jpeg && !has_jpeg_end(file))) return unexpected(Ros2Refusal::kDamagedImage);
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
