#pragma once

#include <cstdint>

#include "deploy/sim/recording/sim_config.hpp"
#include "deploy/sim/recording/sim_motion.hpp"
#include "deploy/sim/world/season_scene.hpp"

namespace fleetloc {

/// Share of the corners in a few rendered images of the left camera that have no surface of a map
/// made in `survey` within 0.3 m, 0..1.
double unmapped_share(const SimMotion& motion,
                      const SeasonScene& season,
                      const SeasonScene& survey,
                      const SimConfig& config,
                      std::uint64_t seed);

}  // namespace fleetloc
