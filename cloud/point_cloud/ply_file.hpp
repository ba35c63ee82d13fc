#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cloud/point_cloud/point_cloud_file.hpp"

namespace fleetloc {

/// The .ply half of read_point_fields(). PCL's own reader mixes up the fields of files with some
/// of the colour properties, and takes a file that is cut off for a shorter one.
PointTable read_ply(const std::filesystem::path& file, const std::vector<std::string>& fields);

}  // namespace fleetloc
