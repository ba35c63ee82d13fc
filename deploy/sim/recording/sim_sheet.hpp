#pragma once

#include <cstdint>
#include <span>

#include <opencv2/core/mat.hpp>

#include "deploy/sim/recording/sim_config.hpp"
#include "deploy/sim/recording/sim_motion.hpp"
#include "deploy/sim/world/season_scene.hpp"

namespace fleetloc {

/// Contact sheet of a world, a row for each season: the image of the left camera at four places of
/// the path, and a lidar scan at the first of them from above (60 m across; what is higher above
/// the lidar is darker).
cv::Mat contact_sheet(const SimMotion& motion,
                      std::span<const SeasonScene> seasons,
                      const SimConfig& config,
                      std::uint64_t seed);

}  // namespace fleetloc
