#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "deploy/evaluation/errors/diagnostics_file.hpp"
#include "shared/trajectory/trajectory.hpp"

namespace fleetloc {

/// One line of answers.csv.
struct AnswerMark {
  Timestamp arrival;
  bool applied = false;
};

/// A run folder, read.
struct RunData {
  std::string name;
  Timestamp begin;  ///< first frame; figures count from here
  Trajectory odometry;
  Trajectory localized;     ///< localization_frames.tum
  Trajectory aligned_once;  ///< the control, see dead_reckoning.hpp
  std::vector<FrameDiagnostics> frames;
  RunCovariances covariances;
  std::vector<AnswerMark> answers;
  nlohmann::json summary;
  std::optional<std::string> config;  ///< config.yaml, of a run that has it

  [[nodiscard]] double seconds(Timestamp stamp) const { return to_seconds(stamp - begin); }
};

/// Throws std::runtime_error that names the file which is missing or wrong.
RunData read_run(const std::filesystem::path& folder);

nlohmann::json read_json(const std::filesystem::path& file);

/// Poses of a run with the ground truth. All are in the frame of the map.
struct RunErrors {
  std::vector<PosePair> localized;
  std::vector<PosePair> aligned_once;
  /// Odometry alone, aligned in position and heading at its first pose, so that only its drift
  /// remains.
  std::vector<PosePair> odometry;
};

RunErrors errors_of(const RunData& run, const Trajectory& truth, Duration max_gap);

/// Error of position, estimate minus truth, in the axes of the map [m].
Eigen::Vector3d position_error(const PosePair& pair);
/// Error of heading about the z axis of the map [deg].
double yaw_error_deg(const PosePair& pair);

/// One sigma of position in the axes of the map [m], and of heading [deg]. The covariance is one of
/// a right perturbation, so it is turned from body to map.
struct MapSigmas {
  Eigen::Vector3d position_m;
  double yaw_deg;
};
MapSigmas map_sigmas(const Pose& T_map_body, const Matrix6d& covariance);

}  // namespace fleetloc
