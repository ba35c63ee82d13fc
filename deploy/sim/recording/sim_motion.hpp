#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "deploy/sim/motion/recorded_motion.hpp"
#include "deploy/sim/recording/sim_config.hpp"

namespace fleetloc {

/// The ground truth of a simulation.
struct SimMotion {
  SplineMotion motion;
  Timestamp start;  ///< stamp of its time zero
  /// Positions of the body along which a world is built [m]; the same for any seed and rest.
  std::vector<Eigen::Vector3d> path_map = {};
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

/// SimMotion::path_map for a file as in SimMotionOptions.
std::vector<Eigen::Vector3d> path_along(const std::filesystem::path& file, const SimConfig& config);

/// Throws std::invalid_argument where `path_map` comes within half a metre of objects beside the
/// streets, or leaves their ground.
///
/// @param streets_m    path that the world was built along
/// @param clearance_m  around the streets, in which nothing stands
void expect_within(std::span<const Eigen::Vector3d> path_map,
                   std::span<const Eigen::Vector3d> streets_m,
                   double clearance_m);

/// Motion along recorded poses, nearly unsmoothed (`replayed_record`).
SimMotion replayed_motion(const std::filesystem::path& file, const SimConfig& config);

/// Text for the user, several lines: length, duration, greatest values, residual to the record.
std::string description(const SimMotion& motion);

}  // namespace fleetloc
