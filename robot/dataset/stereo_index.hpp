#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "shared/core/time.hpp"

namespace fleetloc {

/// One line of an image list.
struct ImageEntry {
  Timestamp stamp;
  std::filesystem::path file;
  std::string where;  ///< "data.csv:12", for messages
};

/// Two images of one instant, or one where the other is missing.
struct StereoEntry {
  Timestamp stamp;  ///< of the left image if there is one
  std::optional<ImageEntry> left;
  std::optional<ImageEntry> right;
};

/// Reads `camera_folder`/data.csv. Throws DatasetError for a wrong line, for stamps that do not
/// increase and for a listed file that does not exist.
std::vector<ImageEntry> read_image_list(const std::filesystem::path& camera_folder);

/// Pairs images whose stamps differ by 2 ms at most; in the order of time. Throws DatasetError if
/// both cameras have images and none of them are a pair.
std::vector<StereoEntry> pair_images(const std::vector<ImageEntry>& left,
                                     const std::vector<ImageEntry>& right);

}  // namespace fleetloc
