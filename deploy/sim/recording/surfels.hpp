#pragma once

#include "cloud/laser_map/laser_map.hpp"
#include "deploy/sim/recording/sim_config.hpp"
#include "deploy/sim/world/season_scene.hpp"

namespace fleetloc {

/// A world made of squares, one at each point of the map that has a normal, across it, as large as
/// the distance to its neighbours asks for. Solid textures, different on level and on upright
/// surfaces and from room corner to room corner; light from everywhere, no sun.
SeasonScene surfel_scene(const LaserMap& map, const SurfelConfig& config);

}  // namespace fleetloc
