#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "deploy/sim/motion/recorded_motion.hpp"
#include "deploy/sim/recording/sim_config.hpp"

namespace fleetloc {

/// The truth of a simulation.
struct SimMotion {
  SplineMotion motion;
  Timestamp start;  ///< stamp of its time zero
  /// Where the body goes, for a world to be built around it: the same for any seed and rest.
  std::vector<Eigen::Vector3d> way_m = {};
  std::optional<RecordFit> fit = {};  ///< of recorded poses
};

struct SimMotionOptions {
  std::filesystem::path file;  ///< a route (.yaml) or poses (.tum, .txt, .csv of EuRoC)
  double rest_s = 0.0;         ///< standing still before a record begins
  std::uint64_t seed = 0;      ///< of the vibration
};

/// Drives a route or along recorded poses, within the limits, with vibration. Throws what is wrong
/// with the file, and std::invalid_argument where limits cannot be kept.
SimMotion driven_motion(const SimMotionOptions& options, const SimConfig& config);

/// The way of the body along a file as of SimMotionOptions, for a world to be built around it.
std::vector<Eigen::Vector3d> way_along(const std::filesystem::path& file, const SimConfig& config);

/// Throws std::invalid_argument where `way_m` comes nearer than half a metre to what stands beside
/// the streets, or off their ground.
///
/// @param streets_m    ways that the world was built around
/// @param clearance_m  about the streets, in which nothing stands
void expect_within(std::span<const Eigen::Vector3d> way_m,
                   std::span<const Eigen::Vector3d> streets_m,
                   double clearance_m);

/// Recorded poses as they are.
SimMotion replayed_motion(const std::filesystem::path& file, const SimConfig& config);

/// Lines for the user: length, duration, greatest values, residual to the record.
std::string description(const SimMotion& motion);

}  // namespace fleetloc
