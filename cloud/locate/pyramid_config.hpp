#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "cloud/laser_map/laser_map.hpp"
#include "cloud/locate/map_pyramid.hpp"
#include "shared/config/config_reader.hpp"

namespace fleetloc {

/// How finely maps are searched, whatever their size.
struct PyramidConfig {
  double min_cell_m;
  double max_cell_m;
  int cells;          ///< along the longer side of the map, as far as the edge of a cell permits
  int levels;         ///< see MapPyramid::Config
  double level_from;  ///< the same
};

PyramidConfig read_pyramid_config(ConfigReader section);

/// The cells of a map of this extent.
MapPyramid::Config pyramid_cells(const MapInfo& map, const PyramidConfig& config);

std::shared_ptr<const MapPyramid> make_pyramid(const LaserMap& map, const PyramidConfig& config);

/// One that is stored beside the map, if that fits the map and the configuration; else it is made.
struct PreparedPyramid {
  std::shared_ptr<const MapPyramid> pyramid;
  std::string why_made;  ///< what is the matter with the stored one, e.g. "is damaged"; or empty
};
PreparedPyramid prepare_pyramid(const LaserMap& map,
                                const std::filesystem::path& pcd_file,
                                const PyramidConfig& config);

}  // namespace fleetloc
