#pragma once

#include <filesystem>

#include <nlohmann/json.hpp>

#include "deploy/evaluation/errors/alignment.hpp"
#include "deploy/evaluation/errors/trajectory_error.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/trajectory/trajectory.hpp"

namespace fleetloc {

struct EvaluationConfig {
  Duration max_gap{};            ///< that the ground truth is interpolated across
  Duration relative_interval{};  ///< that the relative error of the odometry is taken over
};

EvaluationConfig read_evaluation_config(ConfigReader section);

/// {median, mean, rmse, std, max}
nlohmann::json to_json(const Statistics& statistics);

/// One estimate against the ground truth: `poses` compared, `unmatched` poses without ground
/// truth, `translation_m` and `rotation_deg`. Throws std::runtime_error if no pose can be compared.
nlohmann::json evaluate(const Trajectory& truth,
                        const Trajectory& estimate,
                        Alignment alignment,
                        const EvaluationConfig& config);

/// What evaluation.json of a run folder holds. A value that the run does not allow (it was never
/// localized, or is shorter than an interval) is null.
///
/// - `ate`, `rotation_deg`: of localization_frames.tum as it is
/// - `odometry_ate`, `odometry_rotation_deg`: of odometry.tum, aligned in SE(3)
/// - `aligned_once`: `ate` and `rotation_deg` of the control (see dead_reckoning.hpp) at the frames
///   of localization_frames.tum, and the `ratio` {median, rmse} of its `ate` to the run's
/// - `confidence`: see eval_confidence.hpp
/// - `first_place`, `carried_away`: see eval_place.hpp
/// - `odometry_relative`: of the same, over relative_interval, no alignment: `pairs`,
///   `translation_rmse_m`, `rotation_rmse_deg`
/// - `covered`: share of the frames after the first pose that are localized and truly within 0.25 m
///   and 2 degrees, see eval_confidence.hpp
/// - `coverage`: of summary.json, which knows no ground truth
/// - `nees` {map, odom}: means over the frames of diagnostics.csv, per degree of freedom; for odom
///   position and heading are aligned at its first pose
///
/// Throws std::runtime_error for files that cannot be read, and for a run with odometry of which no
/// pose has ground truth.
nlohmann::json evaluate_run(const std::filesystem::path& run,
                            const Trajectory& truth,
                            const EvaluationConfig& config);

}  // namespace fleetloc
