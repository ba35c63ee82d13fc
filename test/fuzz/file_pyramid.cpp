#include <xxhash.h>

#include "cloud/locate/pyramid_file.hpp"
#include "test/fuzz/input_files.hpp"

/// The input lacks the checksum at the end, which no mutation would ever meet.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  std::string content(reinterpret_cast<const char*>(data), size);
  const std::uint64_t checksum = XXH3_64bits(data, size);
  content.append(reinterpret_cast<const char*>(&checksum), sizeof(checksum));
  const auto file = input_file("map.pyramid", content);
  const auto pyramid =
      load_pyramid(file, MapHash{1, 2, 3}, {.cell_m = 0.5, .levels = 4, .level_from = 0.9});
  if (!pyramid) return 0;
  const Eigen::Vector3i& min = pyramid->min();
  static_cast<void>(pyramid->ground().at(1.0, -1.0));
  static_cast<void>(pyramid->value(min.x(), min.y(), min.z()));
  static_cast<void>(
      pyramid->windows(pyramid->levels() - 1, pyramid->any_height()).largest(min.x(), min.y()));
  return 0;
}
