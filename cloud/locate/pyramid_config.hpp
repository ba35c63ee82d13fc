#pragma once

#include <memory>

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

std::shared_ptr<const MapPyramid> make_pyramid(const LaserMap& map, const PyramidConfig& config);

}  // namespace fleetloc
