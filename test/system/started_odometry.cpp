#include "test/system/started_odometry.hpp"

#include <cmath>
#include <numbers>

#include "deploy/config/default_config.hpp"
#include "deploy/evaluation/errors/alignment.hpp"
#include "deploy/replay/simulated_back_end.hpp"
#include "robot/dataset/dataset_reader.hpp"
#include "robot/pipeline/robot_pipeline.hpp"
#include "shared/trajectory/tum_file.hpp"

namespace fleetloc {
namespace {

constexpr Duration kMaxGap = std::chrono::milliseconds(100);  // of the ground truth

/// In full milliseconds: stamps jitter.
double frame_period_s(const std::filesystem::path& dataset) {
  const Duration between = first_frame(dataset, 1e-6) - first_frame(dataset);
  return 1e-3 * std::round(1e3 * to_seconds(between));
}

std::optional<double> speed_at(const Trajectory& truth, Timestamp stamp) {
  constexpr double kHalf = 0.1;  // [s]
  const auto before = interpolate(truth, stamp - from_seconds(kHalf), kMaxGap);
  const auto after = interpolate(truth, stamp + from_seconds(kHalf), kMaxGap);
  if (!before || !after) return std::nullopt;
  return (after->p - before->p).norm() / (2.0 * kHalf);
}

/// The odometry's poses at frames, each as known at that frame.
Trajectory played(const DatasetReader::Options& options, const StartWatch& watch) {
  const ConfigReader config = ConfigReader::from_string(std::string(default_config("everything")));
  DatasetReader reader(options);
  SimulatedBackEnd back_end(KeyframeWorker(rectified(reader.calibration()),
                                           reader.imu_noise(),
                                           read_keyframe_worker_config(config),
                                           {}),
                            std::chrono::milliseconds(50));
  RobotPipeline pipeline({.id = "robot",
                          .calibration = reader.calibration(),
                          .imu_noise = reader.imu_noise(),
                          .T_map_body = std::nullopt},
                         read_robot_pipeline_config(config),
                         back_end,
                         nullptr);
  Trajectory odometry;
  std::optional<Timestamp> begin;
  while (auto item = reader.next()) {
    if (auto* frame = std::get_if<CameraFrame>(&*item)) {
      if (!begin) begin = stamp_of(*frame);
      pipeline.add_frame(std::move(*frame));
      continue;
    }
    const auto& sample = std::get<ImuSample>(*item);
    pipeline.add_imu(sample);
    pipeline.poll(sample.stamp);
    for (const FrameOutput& frame : pipeline.take_frames()) {
      if (frame.pose.quality == Quality::kInitializing) continue;
      odometry.push_back({frame.stamp, frame.pose.T_odom_body});
    }
    const Timestamp end = odometry.empty()
                              ? begin.value_or(sample.stamp) + from_seconds(watch.patience_s)
                              : odometry.front().stamp + from_seconds(watch.stretch_s);
    if (sample.stamp > end) break;
  }
  return odometry;
}

double path_of(std::span<const PosePair> pairs) {
  double path = 0.0;
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    path += (pairs[i].T_truth_body.p - pairs[i - 1].T_truth_body.p).norm();
  }
  return path;
}

/// s of: estimate = s * R * truth + p.
double scale_of(std::span<const PosePair> pairs) {
  const Pose T_truth_estimate = align(pairs, Alignment::kSe3);
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const PosePair& pair : pairs) center += pair.T_truth_body.p;
  center /= static_cast<double>(pairs.size());
  double across = 0.0;
  double spread = 0.0;
  for (const PosePair& pair : pairs) {
    const Eigen::Vector3d truth = pair.T_truth_body.p - center;
    across += truth.dot(T_truth_estimate * pair.T_estimate_body.p - center);
    spread += truth.squaredNorm();
  }
  return across / spread;
}

double gravity_error_deg(const PosePair& pair) {
  const Eigen::Vector3d up_truth = pair.T_truth_body.R.conjugate() * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d up_odom = pair.T_estimate_body.R.conjugate() * Eigen::Vector3d::UnitZ();
  return 180.0 / std::numbers::pi *
         std::atan2(up_truth.cross(up_odom).norm(), up_truth.dot(up_odom));
}

}  // namespace

std::vector<double> starts_in_motion(const RecordedFlight& flight, const StartChoice& choice) {
  const Trajectory truth = read_trajectory(flight.ground_truth);
  const Timestamp first = first_frame(flight.folder);
  const double period_s = frame_period_s(flight.folder);
  const auto frames = static_cast<int>(*DatasetReader({.folder = flight.folder}).frame_count());
  const auto playing = static_cast<int>(std::lround(choice.playing_s / period_s));
  std::vector<double> moving;
  for (int frame = 0; frame + playing <= frames; ++frame) {
    const double start_s = period_s * frame;
    const auto speed = speed_at(truth, first + from_seconds(start_s));
    if (speed && *speed > choice.min_speed) moving.push_back(start_s);
  }
  if (moving.empty() || choice.count < 2) return moving;
  std::vector<double> starts;
  for (int i = 0; i < choice.count; ++i) {
    const double share = static_cast<double>(i) / (choice.count - 1);
    starts.push_back(moving[static_cast<std::size_t>(
        std::lround(share * static_cast<double>(moving.size() - 1)))]);
  }
  return starts;
}

StartOutcome started_at(double start_s, const RecordedFlight& flight, const StartWatch& watch) {
  StartOutcome outcome;
  outcome.start_s = start_s;
  const Trajectory odometry = played({.folder = flight.folder,
                                      .start_s = start_s,
                                      .duration_s = watch.patience_s + watch.stretch_s},
                                     watch);
  if (odometry.empty()) return outcome;
  const Timestamp start = first_frame(flight.folder) + from_seconds(start_s);
  outcome.first_pose_s = to_seconds(odometry.front().stamp - start);
  const auto pairs = associate(read_trajectory(flight.ground_truth), odometry, kMaxGap);
  if (pairs.size() < 3) return outcome;
  outcome.path_m = path_of(pairs);
  outcome.scale_error = scale_of(pairs) - 1.0;
  outcome.first_gravity_error_deg = gravity_error_deg(pairs.front());
  for (const PosePair& pair : pairs) {
    if (pair.stamp > start + from_seconds(watch.patience_s)) break;
    outcome.gravity_error_deg = gravity_error_deg(pair);
  }
  return outcome;
}

}  // namespace fleetloc
