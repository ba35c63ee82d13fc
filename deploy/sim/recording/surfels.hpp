#pragma once

#include "cloud/laser_map/laser_map.hpp"
#include "deploy/sim/recording/sim_config.hpp"
#include "deploy/sim/world/season_scene.hpp"

namespace fleetloc {

/// A world of surfels: a square at each point of the map that has a normal, with a size by the
/// distance to its neighbours. Solid textures, different on level and on upright surfaces and from
/// tile to tile; ambient light, no sun.
SeasonScene surfel_scene(const LaserMap& map, const SurfelConfig& config);

}  // namespace fleetloc
