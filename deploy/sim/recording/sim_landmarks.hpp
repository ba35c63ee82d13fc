#pragma once

#include <cstdint>

#include "deploy/sim/recording/sim_config.hpp"
#include "deploy/sim/recording/sim_motion.hpp"
#include "deploy/sim/world/season_scene.hpp"

namespace fleetloc {

/// How much of what the left camera would see along the way is not in a map made in `survey`: the
/// share of the corners of a few rendered images without a surface of it within 0.3 m, 0..1.
double unmapped_share(const SimMotion& motion,
                      const SeasonScene& season,
                      const SeasonScene& survey,
                      const SimConfig& config,
                      std::uint64_t seed);

}  // namespace fleetloc
