#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <stop_token>

#include "deploy/sim/recording/sim_config.hpp"
#include "deploy/sim/recording/sim_motion.hpp"
#include "deploy/sim/sensors/track_statistics.hpp"
#include "deploy/sim/world/season_scene.hpp"
#include "robot/tracking/feature_tracker.hpp"

namespace fleetloc {

/// The frames of a simulation.
struct SimFrames {
  const SimMotion* motion;
  const SeasonScene* scene;
  std::uint64_t first = 0;  ///< number of the first frame; they count from the motion's time zero
  std::uint64_t end = 0;
};

/// Writes feature tracks into `folder`, see TrackFiles.
/// @return number of frames; fewer than asked for if a stop is requested
std::size_t write_tracks(const SimFrames& frames,
                         const SimConfig& config,
                         std::uint64_t seed,
                         const std::filesystem::path& folder,
                         const std::stop_token& stop);

/// Statistics of simulated tracks, and of those of a robot's front end on rendered images.
struct TrackComparison {
  TrackStatistics simulated;
  TrackStatistics tracked;
};
TrackComparison compare_tracks(const SimFrames& frames,
                               const SimConfig& config,
                               const FeatureTracker::Config& front_end,
                               std::uint64_t seed,
                               const std::stop_token& stop);

}  // namespace fleetloc
