#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace fleetloc {

// What decoders of images do not ask before they take memory, or do not tell: of which kind a file
// is, and how many pixels it has.

/// Larger images are refused [px].
inline constexpr std::uint64_t kMaxPixels = 64'000'000;

inline bool is_jpeg(std::span<const std::uint8_t> file) {
  constexpr std::array<std::uint8_t, 3> kBegin{0xff, 0xd8, 0xff};
  return file.size() >= kBegin.size() && std::ranges::equal(file.first(kBegin.size()), kBegin);
}

inline bool is_png(std::span<const std::uint8_t> file) {
  constexpr std::array<std::uint8_t, 8> kBegin{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  return file.size() >= kBegin.size() && std::ranges::equal(file.first(kBegin.size()), kBegin);
}

inline std::uint64_t big_endian(std::span<const std::uint8_t> bytes) {
  std::uint64_t value = 0;
  for (const std::uint8_t byte : bytes) value = 256 * value + byte;
  return value;
}

/// Width times height, from the chunk that a PNG begins with.
inline std::optional<std::uint64_t> png_pixels(std::span<const std::uint8_t> file) {
  constexpr std::size_t kWidth = 16;
  constexpr std::size_t kHeight = 20;
  if (file.size() < kHeight + 4) return std::nullopt;
  return big_endian(file.subspan(kWidth, 4)) * big_endian(file.subspan(kHeight, 4));
}

/// Width times height, from the first frame of a JPEG (ITU T.81, B.2.2).
inline std::optional<std::uint64_t> jpeg_pixels(std::span<const std::uint8_t> file) {
  // Markers of frames: C0 to CF, but for those of tables and extensions.
  const auto is_frame = [](std::uint8_t marker) {
    return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
  };
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

/// Of a JPEG or PNG file; nothing if it does not say.
inline std::optional<std::uint64_t> image_pixels(std::span<const std::uint8_t> file) {
  if (is_jpeg(file)) return jpeg_pixels(file);
  return is_png(file) ? png_pixels(file) : std::nullopt;
}

}  // namespace fleetloc
