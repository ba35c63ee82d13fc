#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cloud/point_cloud/point_cloud_file.hpp"

namespace fleetloc {

/// read_point_fields() for .ply. PCL's own reader mixes up the fields of files with some of the
/// colour properties, and accepts truncated files.
PointTable read_ply(const std::filesystem::path& file, const std::vector<std::string>& fields);

}  // namespace fleetloc
