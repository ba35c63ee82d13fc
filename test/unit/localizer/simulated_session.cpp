#include "simulated_session.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Cholesky>

#include "cloud/laser_map/build_map.hpp"
#include "deploy/config/default_config.hpp"
#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

enum Stream : std::uint64_t {
  kStart = 100,
  kEdgeRotation,
  kEdgeTranslation,
  kMapNoise,
  kOffMap,
  kOffMapNoise,
};

constexpr double kTiltSigma = 0.0035;  // [rad]

SimulatedRun::Config run_config(const SimulatedSession::Config& config) {
  SimulatedRun::Config result;
  result.seed = config.seed;
  result.frame_rate_hz = config.keyframe_rate_hz;
  result.features_per_frame = config.features_per_keyframe;
  result.pixel_sigma = config.pixel_sigma;
  return result;
}

// Into the room, away from what the map holds.
Eigen::Vector3d off_map(const Eigen::Vector3d& p_map) {
  const Eigen::Vector3d middle(0.0, 0.0, 2.0);
  return middle + 0.8 * (p_map - middle);
}

// At the first keyframe, gravity aligned, any yaw.
Pose odom_at(const Pose& T_map_body, std::uint64_t seed) {
  const auto yaw = static_cast<double>(seed);
  return {exp_so3(yaw * Eigen::Vector3d::UnitZ()), T_map_body.p};
}

Pose moved(const Eigen::Vector3d& p) {
  return {Eigen::Quaterniond::Identity(), p};
}

}  // namespace

SessionLocalizer::Config localizer_config() {
  return read_session_localizer_config(
      ConfigReader::from_string(default_config("cloud")).section("localizer"));
}

LaserMap map_of(const std::vector<Eigen::Vector3d>& points, double noise_m, std::uint64_t seed) {
  const CounterRandom random(seed, kMapNoise);
  std::vector<Eigen::Vector3f> noisy;
  noisy.reserve(points.size());
  for (const Eigen::Vector3d& p_map : points) {
    noisy.emplace_back((p_map + noise_m * random.normal3(noisy.size())).cast<float>());
  }
  return build_map(
      noisy, "room", {.resolution_m = 0.08, .normal_radius_m = 0.25, .min_neighbours = 5});
}

std::shared_ptr<const LaserMap> room_map() {
  static const auto map =
      std::make_shared<const LaserMap>(map_of(SimulatedRun({}).surface_points(0.06), 0.01, 1));
  return map;
}

std::shared_ptr<const LaserMap> two_rooms(
    const Eigen::Vector3d& apart, const std::function<bool(const Eigen::Vector3d&)>& has_too) {
  const std::vector<Eigen::Vector3d> room = SimulatedRun({}).surface_points(0.06);
  std::vector<Eigen::Vector3d> both = room;
  for (const Eigen::Vector3d& p : room) {
    if (has_too(p)) both.emplace_back(p + apart);
  }
  return std::make_shared<const LaserMap>(map_of(both, 0.01, 1));
}

Matrix6d start_covariance() {
  Vector6d sigmas;
  sigmas << 0.017, 0.017, 0.052, 0.2, 0.2, 0.2;
  return sigmas.cwiseAbs2().asDiagonal();
}

SimulatedSession::SimulatedSession(const Config& config)
    : config_(config),
      run_(run_config(config)),
      T_map_odom_(odom_at(truth(0), config.seed) * moved(-config.begin_odom)) {}

RobotSession SimulatedSession::session() const {
  const CounterRandom random(config_.seed, kStart);
  const double direction = 2.0 * std::numbers::pi * random.uniform(0);
  const double sign = random.uniform(1) < 0.5 ? -1.0 : 1.0;
  const Pose offset{
      exp_so3(sign * config_.start_yaw_rad * Eigen::Vector3d::UnitZ()),
      config_.start_offset_m * Eigen::Vector3d(std::cos(direction), std::sin(direction), 0.0)};
  RobotSession session;
  session.robot = "robot";
  session.stereo = run_.stereo();
  const Pose T_odom_begin = moved(config_.begin_odom);
  const Matrix6d A = adjoint(T_odom_begin);
  session.start = MapOdomEstimate{
      .T_map_odom = T_map_odom_ * T_odom_begin * offset * moved(-config_.begin_odom),
      .covariance = A * start_covariance() * A.transpose(),
      .p_odom = config_.begin_odom};
  return session;
}

Pose SimulatedSession::truth(int keyframe) const {
  return run_.truth(run_.frame_stamp(keyframe)).T_odom_body;
}

Pose SimulatedSession::T_odom_body(int keyframe) const {
  return inverse(T_map_odom_) * truth(keyframe);
}

VirtualEdge SimulatedSession::edge_to(int keyframe) const {
  const auto index = static_cast<std::uint64_t>(keyframe);
  Vector6d noise;
  noise << config_.edge_sigma_rad * CounterRandom(config_.seed, kEdgeRotation).normal3(index),
      config_.edge_sigma_m * CounterRandom(config_.seed, kEdgeTranslation).normal3(index);
  VirtualEdge edge;
  edge.from = KeyframeId{static_cast<std::uint32_t>(keyframe - 1)};
  edge.to = KeyframeId{static_cast<std::uint32_t>(keyframe)};
  edge.T_from_to = retract(inverse(truth(keyframe - 1)) * truth(keyframe), noise);
  edge.information.setZero();
  edge.information.diagonal().head<3>().setConstant(std::pow(config_.edge_sigma_rad, -2));
  edge.information.diagonal().tail<3>().setConstant(std::pow(config_.edge_sigma_m, -2));
  return edge;
}

bool SimulatedSession::is_off_map(LandmarkId id) const {
  const CounterRandom random(config_.seed, kOffMap);
  return random.uniform(static_cast<std::uint64_t>(id)) < config_.off_map_share;
}

std::vector<StereoObservation> SimulatedSession::observations(int keyframe) const {
  std::vector<StereoObservation> result;
  const Pose T_cam0_map = inverse(truth(keyframe) * run_.stereo().T_body_cam0);
  const CounterRandom noise(config_.seed, kOffMapNoise);
  for (StereoObservation seen : run_.frame(keyframe).observations) {
    const Eigen::Vector3d p_map = run_.landmark(seen.landmark);
    if (config_.is_wanted && !config_.is_wanted(p_map)) continue;
    const bool is_off = is_off_map(seen.landmark);
    if (is_off || (config_.noise_of_right_pixel && seen.disparity > 0.0)) {
      const auto counter =
          (static_cast<std::uint64_t>(keyframe) << 32U) | static_cast<std::uint64_t>(seen.landmark);
      const Eigen::Vector3d pixel =
          project(run_.stereo(), T_cam0_map * (is_off ? off_map(p_map) : p_map)) +
          config_.pixel_sigma * noise.normal3(counter);
      seen.left = pixel.head<2>();
      seen.disparity = std::max(0.0, pixel[0] - pixel[2]);
    }
    result.push_back(seen);
  }
  return result;
}

Submap SimulatedSession::submap(int keyframe) const {
  SubmapKeyframe item;
  item.id = KeyframeId{static_cast<std::uint32_t>(keyframe)};
  item.stamp = run_.frame_stamp(keyframe);
  item.T_odom_body = T_odom_body(keyframe);
  item.tilt_sigma = kTiltSigma;
  item.observations = observations(keyframe);
  Submap submap;
  submap.number = SampleNumber{static_cast<std::uint32_t>(keyframe)};
  if (keyframe > 0) submap.edges.push_back(edge_to(keyframe));
  if (config_.send_landmarks) {
    for (const StereoObservation& seen : item.observations) {
      submap.landmarks.push_back(
          {seen.landmark, inverse(T_map_odom_) * run_.landmark(seen.landmark)});
    }
  }
  submap.keyframes.push_back(std::move(item));
  return submap;
}

double nees(const LocalizationResult& answer, const Pose& truth) {
  const Vector6d error = local_coordinates(answer.T_map_body, truth);
  return error.dot(answer.covariance.ldlt().solve(error));
}

double position_error(const LocalizationResult& answer, const Pose& truth) {
  return (answer.T_map_body.p - truth.p).norm();
}

double rotation_error(const LocalizationResult& answer, const Pose& truth) {
  return log_so3(answer.T_map_body.R.conjugate() * truth.R).norm();
}

}  // namespace fleetloc
