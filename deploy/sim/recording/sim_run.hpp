#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <stop_token>

#include "deploy/sim/recording/sim_config.hpp"
#include "deploy/sim/recording/sim_motion.hpp"
#include "deploy/sim/world/season_scene.hpp"

namespace fleetloc {

struct SimOptions {
  std::filesystem::path out;
  std::uint64_t seed = 1;
  int threads = 2;
  bool images = true;
  bool tracks = false;  ///< mav0/tracks0, see TrackFiles
  bool lidar = false;
  bool merged_cloud = false;           ///< of the scans, with `lidar`
  std::filesystem::path recorded_imu;  ///< copied instead of a simulated one; empty: none
  double begin_s = 0.0;                ///< part of the motion
  double end_s = 0.0;
};

/// What was written.
struct SimCounts {
  std::size_t frames = 0;
  std::size_t scans = 0;
  std::size_t merged_points = 0;
  double merged_voxel_m = 0.0;
};

/// Writes the dataset; ends early, with what there is by then, if a stop is requested. The same
/// bytes for one seed, however many threads work. Throws DatasetError and PointCloudError.
SimCounts simulate(const SimMotion& motion,
                   const SeasonScene& scene,
                   const SimConfig& config,
                   const SimOptions& options,
                   const std::stop_token& stop);

/// Throws DatasetError if the folder holds a dataset already.
void expect_no_dataset(const std::filesystem::path& out);

}  // namespace fleetloc
