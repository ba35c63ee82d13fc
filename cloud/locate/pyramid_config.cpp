#include "cloud/locate/pyramid_config.hpp"

#include <algorithm>
#include <utility>

#include "cloud/locate/pyramid_file.hpp"

namespace fleetloc {

PyramidConfig read_pyramid_config(ConfigReader section) {
  PyramidConfig config{.min_cell_m = section.positive("min_cell_m"),
                       .max_cell_m = section.positive("max_cell_m"),
                       .cells = section.integer("cells", 1, 100'000),
                       .levels = section.integer("levels", 1, 16),
                       .level_from = section.number("level_from", 0.0, 1.0)};
  if (config.max_cell_m < config.min_cell_m) section.fail("max_cell_m", "is less than min_cell_m");
  return config;
}

MapPyramid::Config pyramid_cells(const MapInfo& map, const PyramidConfig& config) {
  const double side_m = (map.max - map.min).head<2>().maxCoeff();
  const double cell_m = std::clamp(side_m / config.cells, config.min_cell_m, config.max_cell_m);
  return {.cell_m = cell_m, .levels = config.levels, .level_from = config.level_from};
}

std::shared_ptr<const MapPyramid> make_pyramid(const LaserMap& map, const PyramidConfig& config) {
  return std::make_shared<const MapPyramid>(map, pyramid_cells(map.info(), config));
}

PreparedPyramid prepare_pyramid(const LaserMap& map,
                                const std::filesystem::path& pcd_file,
                                const PyramidConfig& config) {
  const MapInfo& info = map.info();
  auto stored = load_pyramid(pyramid_file(pcd_file), info.hash, pyramid_cells(info, config));
  if (!stored) return {make_pyramid(map, config), std::move(stored.error())};
  return {std::make_shared<const MapPyramid>(std::move(*stored)), {}};
}

}  // namespace fleetloc
