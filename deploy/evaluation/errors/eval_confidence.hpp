#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "deploy/evaluation/errors/diagnostics_file.hpp"
#include "shared/trajectory/trajectory.hpp"

namespace fleetloc {

/// How reliable the state `localized` was:
///
/// - `localized_frames`: frames in that state that have ground truth
/// - `worst_m`: the largest error of position among them
/// - `confidently_wrong`: how many of them are wrong by more than 0.5 m and, at once, by more than
///   three sigmas of the stated covariance of position
nlohmann::json confidence(const std::vector<PosePair>& map_poses,
                          const RunCovariances& covariances);

}  // namespace fleetloc
