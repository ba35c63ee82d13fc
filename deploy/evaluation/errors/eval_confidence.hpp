#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "deploy/evaluation/errors/diagnostics_file.hpp"
#include "shared/trajectory/trajectory.hpp"

namespace fleetloc {

/// What a pose that is called `localized` must truly be within.
inline constexpr double kCoveredMetres = 0.25;
inline constexpr double kCoveredDegrees = 2.0;

/// Share of the frames after the first pose that are `localized` and truly within 0.25 m and
/// 2 degrees. Frames without ground truth are left out; null if none is left.
/// @param map_poses  T_map_body at frame times, with its ground truth
/// @param max_gap    that the ground truth is interpolated across
nlohmann::json covered(const Trajectory& truth,
                       const std::vector<PosePair>& map_poses,
                       const RunCovariances& covariances,
                       Duration max_gap);

/// How reliable the state `localized` was; null if no frame with ground truth had it:
///
/// - `localized_frames`: frames in that state that have ground truth
/// - `worst_m`, `worst_deg`: the largest errors among them
/// - `wrong`: how many of them are not within 0.25 m and 2 degrees
/// - `confidently_wrong`: how many of these are wrong by more than three sigmas as well, of the
///   stated covariance of what is beyond its limit (position or rotation)
nlohmann::json confidence(const std::vector<PosePair>& map_poses,
                          const RunCovariances& covariances);

}  // namespace fleetloc
