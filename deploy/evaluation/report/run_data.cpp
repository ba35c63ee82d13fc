#include "deploy/evaluation/report/run_data.hpp"

#include <fstream>
#include <stdexcept>

#include "deploy/evaluation/errors/alignment.hpp"
#include "deploy/evaluation/errors/dead_reckoning.hpp"
#include "shared/config/delimited_file.hpp"
#include "shared/geometry/angle.hpp"
#include "shared/geometry/so3.hpp"
#include "shared/trajectory/tum_file.hpp"

namespace fleetloc {
namespace {

std::optional<std::string> text_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) return std::nullopt;
  return std::string{std::istreambuf_iterator<char>(stream), {}};
}

std::vector<AnswerMark> read_answers(const std::filesystem::path& path) {
  constexpr std::size_t kArrival = 1;
  constexpr std::size_t kApplied = 5;
  DelimitedFile file(path, ',');
  if (!file.next() || file.columns() <= kApplied || file.text(kApplied) != "applied") {
    throw TextFileError(path.string() + ": has no header with 'applied' as its sixth column");
  }
  const std::size_t columns = file.columns();
  std::vector<AnswerMark> answers;
  while (file.next()) {
    file.expect_columns(columns);
    answers.push_back({file.seconds(kArrival), file.text(kApplied) == "1"});
  }
  return answers;
}

std::string name_of(const std::filesystem::path& folder) {
  const auto path = folder.lexically_normal();
  return (path.has_filename() ? path : path.parent_path()).filename().string();
}

}  // namespace

nlohmann::json read_json(const std::filesystem::path& file) {
  const auto text = text_of(file);
  if (!text) throw std::runtime_error(file.string() + ": cannot be read");
  try {
    return nlohmann::json::parse(*text);
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(file.string() + ": " + error.what());
  }
}

RunData read_run(const std::filesystem::path& folder) {
  RunData run;
  run.name = name_of(folder);
  run.summary = read_json(folder / "summary.json");
  run.odometry = read_trajectory(folder / "odometry.tum");
  run.localized = read_trajectory(folder / "localization_frames.tum");
  run.aligned_once = aligned_once(run.odometry, run.localized);
  run.frames = read_frame_diagnostics(folder / "diagnostics.csv");
  run.covariances = read_covariances(folder / "diagnostics.csv");
  run.answers = read_answers(folder / "answers.csv");
  run.config = text_of(folder / "config.yaml");
  if (!run.frames.empty()) run.begin = run.frames.front().stamp;
  return run;
}

RunErrors errors_of(const RunData& run, const Trajectory& truth, Duration max_gap) {
  RunErrors errors{.localized = associate(truth, run.localized, max_gap),
                   .aligned_once = associate(truth, run.aligned_once, max_gap),
                   .odometry = associate(truth, run.odometry, max_gap)};
  if (errors.odometry.empty()) return errors;
  const Pose T_map_odom = align_first(errors.odometry);
  for (PosePair& pair : errors.odometry) pair.T_estimate_body = T_map_odom * pair.T_estimate_body;
  return errors;
}

Eigen::Vector3d position_error(const PosePair& pair) {
  return pair.T_estimate_body.p - pair.T_truth_body.p;
}

double yaw_error_deg(const PosePair& pair) {
  return kDegPerRad * log_so3(pair.T_estimate_body.R * pair.T_truth_body.R.conjugate()).z();
}

MapSigmas map_sigmas(const Pose& T_map_body, const Matrix6d& covariance) {
  const Eigen::Matrix3d R = T_map_body.R.toRotationMatrix();
  const Eigen::Matrix3d rotation = R * covariance.topLeftCorner<3, 3>() * R.transpose();
  const Eigen::Matrix3d position = R * covariance.bottomRightCorner<3, 3>() * R.transpose();
  return {.position_m = position.diagonal().cwiseMax(0.0).cwiseSqrt(),
          .yaw_deg = kDegPerRad * std::sqrt(std::max(rotation(2, 2), 0.0))};
}

}  // namespace fleetloc
