#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cloud/point_cloud/point_cloud_file.hpp"

namespace fleetloc {

/// read_point_fields() for .pcd. PCL's own reader believes what a header says: it takes memory for
/// points that are not there, and takes the missing end of a file for zeros.
PointTable read_pcd(const std::filesystem::path& file, const std::vector<std::string>& fields);

}  // namespace fleetloc
