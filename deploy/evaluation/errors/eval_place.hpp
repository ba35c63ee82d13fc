#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "deploy/evaluation/errors/diagnostics_file.hpp"
#include "shared/trajectory/trajectory.hpp"

namespace fleetloc {

/// A pose that is farther off than this is at a wrong place.
inline constexpr double kPlaceMetres = 1.0;
inline constexpr double kPlaceDegrees = 5.0;

/// How a robot came to know its place:
///
/// - `found`: whether it ever had a pose in the map
/// - `after_s`, `way_m`: from the first frame of the run to its first pose in the map; the way is
///   that of the ground truth
/// - `error_m`, `error_deg`: of that pose
/// - `wrong_frames`: frames in the state `localized` at a wrong place
///
/// Null where the run was not localized, but for `found` and `wrong_frames`.
/// @param map_poses  T_map_body at frame times, with its ground truth
nlohmann::json first_place(const Trajectory& truth,
                           const std::vector<PosePair>& map_poses,
                           const RunCovariances& covariances);

/// What happened after somebody carried the robot away, which the ground truth tells by a jump of
/// more than a metre; null without one. The first jump counts.
///
/// - `after_s`: from the first frame of the run to the jump; `distance_m`: of the jump
/// - `noticed_s`: from the jump to the first frame that is not in the state `localized` at a wrong
///   place; null if there is none
/// - `wrong_and_sure_s`: time in the state `localized` at a wrong place, from the jump on
/// - `right_s`, `right_m`: from the jump to the first frame that is `localized` at the right place,
///   and the way until then; null if there is none
nlohmann::json carried_away(const Trajectory& truth,
                            const std::vector<PosePair>& map_poses,
                            const RunCovariances& covariances);

}  // namespace fleetloc
