#pragma once

#include <filesystem>
#include <stdexcept>

#include "cloud/laser_map/laser_map.hpp"

namespace fleetloc {

/// A map that cannot be loaded or saved. The message names the file and what is wrong with it.
class MapFileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The YAML file that belongs to map.pcd: map.yaml beside it.
std::filesystem::path map_info_file(const std::filesystem::path& pcd_file);

/// Writes the points to `pcd_file` (x y z normal_x normal_y normal_z planarity) and frame,
/// resolution, number of points, bounds and content hash beside it. Throws MapFileError.
void save_map(const LaserMap& map, const std::filesystem::path& pcd_file);

/// Reads what save_map() wrote and checks number and content of the points. Throws MapFileError.
LaserMap load_map(const std::filesystem::path& pcd_file);

}  // namespace fleetloc
