#include "deploy/evaluation/errors/eval_run.hpp"

#include <algorithm>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "deploy/evaluation/errors/dead_reckoning.hpp"
#include "deploy/evaluation/errors/diagnostics_file.hpp"
#include "deploy/evaluation/errors/eval_confidence.hpp"
#include "deploy/evaluation/errors/eval_place.hpp"
#include "shared/trajectory/tum_file.hpp"

namespace fleetloc {
namespace {

/// Poses of an estimate that have both ground truth and covariance, as errors in the tangent space.
nlohmann::json mean_nees(const std::vector<PosePair>& pairs,
                         const Pose& T_truth_estimate,
                         const std::vector<StampedCovariance>& covariances) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const PosePair& pair : pairs) {
    const auto found =
        std::ranges::lower_bound(covariances, pair.stamp, {}, &StampedCovariance::stamp);
    if (found == covariances.end() || found->stamp != pair.stamp) continue;
    const auto nees = nees_per_degree_of_freedom(
        pair.T_truth_body, T_truth_estimate * pair.T_estimate_body, found->covariance);
    if (!nees) continue;
    sum += *nees;
    ++count;
  }
  if (count == 0) return nullptr;
  return sum / static_cast<double>(count);
}

nlohmann::json read_coverage(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) return nullptr;
  try {
    return nlohmann::json::parse(stream).value("coverage", nlohmann::json());
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(file.string() + ": " + error.what());
  }
}

nlohmann::json errors_or_null(const std::vector<PosePair>& pairs,
                              const Pose& T_truth_estimate,
                              Statistics TrajectoryError::*which) {
  if (pairs.empty()) return nullptr;
  return to_json(absolute_trajectory_error(pairs, T_truth_estimate).*which);
}

nlohmann::json ratio(double control, double localized) {
  if (localized <= 0.0) return nullptr;
  return control / localized;
}

/// Over the frames that both have, so that the two are compared on the same ground.
nlohmann::json control_or_null(const Trajectory& truth,
                               const Trajectory& localized,
                               const Trajectory& odometry,
                               const EvaluationConfig& config) {
  const Trajectory control = aligned_once(odometry, localized);
  const auto control_pairs = associate(truth, control, config.max_gap);
  const auto pairs = associate(truth, localized, config.max_gap);
  if (control_pairs.empty()) return nullptr;
  const TrajectoryError its = absolute_trajectory_error(control_pairs, {});
  const TrajectoryError error = absolute_trajectory_error(pairs, {});
  return {{"ate", to_json(its.translation_m)},
          {"rotation_deg", to_json(its.rotation_deg)},
          {"ratio",
           {{"median", ratio(its.translation_m.median, error.translation_m.median)},
            {"rmse", ratio(its.translation_m.rmse, error.translation_m.rmse)}}}};
}

nlohmann::json relative_or_null(const std::vector<PosePair>& pairs,
                                const EvaluationConfig& config) {
  const auto error = relative_trajectory_error(pairs, config.relative_interval, config.max_gap);
  if (error.poses == 0) return nullptr;
  return {{"pairs", error.poses},
          {"translation_rmse_m", error.translation_m.rmse},
          {"rotation_rmse_deg", error.rotation_deg.rmse}};
}

}  // namespace

EvaluationConfig read_evaluation_config(ConfigReader section) {
  const auto duration = [&section](const char* key) { return from_seconds(section.positive(key)); };
  return {.max_gap = duration("max_gap_s"), .relative_interval = duration("relative_interval_s")};
}

nlohmann::json to_json(const Statistics& statistics) {
  return {{"median", statistics.median},
          {"mean", statistics.mean},
          {"rmse", statistics.rmse},
          {"std", statistics.std},
          {"max", statistics.max}};
}

nlohmann::json evaluate(const Trajectory& truth,
                        const Trajectory& estimate,
                        Alignment alignment,
                        const EvaluationConfig& config) {
  const auto pairs = associate(truth, estimate, config.max_gap);
  if (pairs.empty()) throw std::runtime_error("no pose of the estimate has ground truth");
  const auto error = absolute_trajectory_error(pairs, align(pairs, alignment));
  return {{"poses", pairs.size()},
          {"unmatched", estimate.size() - pairs.size()},
          {"translation_m", to_json(error.translation_m)},
          {"rotation_deg", to_json(error.rotation_deg)}};
}

nlohmann::json evaluate_run(const std::filesystem::path& run,
                            const Trajectory& truth,
                            const EvaluationConfig& config) {
  const Trajectory localized = read_trajectory(run / "localization_frames.tum");
  const Trajectory odometry = read_trajectory(run / "odometry.tum");
  const auto map = associate(truth, localized, config.max_gap);
  const auto odom = associate(truth, odometry, config.max_gap);
  if (odom.empty() && !odometry.empty()) {
    throw std::runtime_error(
        run.string() + ": no pose of odometry.tum has ground truth; is that of another recording?");
  }
  const RunCovariances covariances = read_covariances(run / "diagnostics.csv");
  const Pose T_truth_odom = align(odom, Alignment::kSe3);
  return {
      {"ate", errors_or_null(map, {}, &TrajectoryError::translation_m)},
      {"rotation_deg", errors_or_null(map, {}, &TrajectoryError::rotation_deg)},
      {"odometry_ate", errors_or_null(odom, T_truth_odom, &TrajectoryError::translation_m)},
      {"odometry_rotation_deg", errors_or_null(odom, T_truth_odom, &TrajectoryError::rotation_deg)},
      {"aligned_once", control_or_null(truth, localized, odometry, config)},
      {"confidence", confidence(map, covariances)},
      {"first_place", first_place(truth, map, covariances)},
      {"carried_away", carried_away(truth, map, covariances)},
      {"odometry_relative", relative_or_null(odom, config)},
      {"covered", covered(truth, map, covariances, config.max_gap)},
      {"coverage", read_coverage(run / "summary.json")},
      {"nees",
       {{"map", mean_nees(map, {}, covariances.map)},
        {"odom", mean_nees(odom, align_first(odom), covariances.odom)}}}};
}

}  // namespace fleetloc
