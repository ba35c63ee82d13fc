#pragma once

#include <cstdint>

#include "deploy/sim/recording/sim_config.hpp"
#include "deploy/sim/recording/sim_motion.hpp"
#include "deploy/sim/world/session_scene.hpp"

namespace fleetloc {

/// How much of what the left camera would see along the way is not in a map made in `survey`: the
/// share of the corners of a few rendered images without a surface of it within 0.3 m, 0..1.
double unmapped_share(const SimMotion& motion,
                      const SessionScene& session,
                      const SessionScene& survey,
                      const SimConfig& config,
                      std::uint64_t seed);

}  // namespace fleetloc
