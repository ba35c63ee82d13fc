#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace fleetloc {

/// Whether a JPEG file (ITU T.81, B.1 and B.2) has the end of its picture: decoders fill up what
/// one lacks. Segments are skipped by their lengths, since a thumbnail in one has an end of its
/// own.
inline bool has_jpeg_end(std::span<const std::uint8_t> file) {
  constexpr std::uint8_t kEnd = 0xd9;
  // Without a segment: a byte FF of the picture (00), TEM, and RST0 to SOI.
  const auto stands_alone = [](std::uint8_t marker) {
    return marker <= 0x01 || (marker >= 0xd0 && marker <= 0xd8);
  };
  std::size_t at = 0;
  while (at + 1 < file.size()) {
    const std::uint8_t marker = file[at + 1];
    if (file[at] != 0xff || marker == 0xff) {  // of the picture, or filled up
      ++at;
    } else if (marker == kEnd) {
      return true;
    } else if (stands_alone(marker)) {
      at += 2;
    } else {
      if (at + 3 >= file.size()) return false;
      at += 2 + std::size_t{256} * file[at + 2] + file[at + 3];
    }
  }
  return false;
}

}  // namespace fleetloc
