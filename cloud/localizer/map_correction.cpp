#include "cloud/localizer/map_correction.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "cloud/localizer/relative_covariance.hpp"

namespace fleetloc {
namespace {

constexpr double kFarthestMetres = 60.0;  // from the anchor: the range of the wire format

struct Candidate {
  const WindowSystem::Landmark* landmark = nullptr;
  double gain = 0.0;  // of information by the map if the poses were known: the determinants' ratio
};

// Where the robot's own estimate of a landmark is too uncertain, the nearest surface may be a wrong
// match.
bool is_placed_by_robot(const WindowSystem::Landmark& landmark, double max_sigma_m) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(landmark.H_robot,
                                                             Eigen::EigenvaluesOnly);
  return eigen.eigenvalues()(0) * max_sigma_m * max_sigma_m >= 1.0;
}

int newest_observer(const WindowSystem::Landmark& landmark) {
  int newest = -1;
  for (const auto& coupling : landmark.equations.couplings) {
    newest = std::max(newest, coupling.kept);
  }
  return newest;
}

int oldest_observer(const WindowSystem::Landmark& landmark) {
  int oldest = std::numeric_limits<int>::max();
  for (const auto& coupling : landmark.equations.couplings) {
    oldest = std::min(oldest, coupling.kept);
  }
  return oldest;
}

// Increasing by id.
std::vector<const WindowSystem::Landmark*> candidates(const WindowSystem& system,
                                                      int first_keyframe,
                                                      const CorrectionConfig& config) {
  std::vector<Candidate> found;
  for (const WindowSystem::Landmark& landmark : system.landmarks) {
    if (!landmark.is_matched || newest_observer(landmark) < first_keyframe) continue;
    if ((landmark.p_map - system.T_map_body.back().p).norm() > kFarthestMetres) continue;
    if (!is_placed_by_robot(landmark, config.max_landmark_sigma_m)) continue;
    found.push_back(
        {&landmark, landmark.equations.H.determinant() / landmark.H_robot.determinant()});
  }
  const auto max_count = 2 * static_cast<std::size_t>(config.max_landmarks);
  if (found.size() > max_count) {
    std::ranges::stable_sort(found, std::greater<>{}, &Candidate::gain);
    found.resize(max_count);
  }
  std::vector<const WindowSystem::Landmark*> result;
  result.reserve(found.size());
  for (const Candidate& candidate : found) result.push_back(candidate.landmark);
  std::ranges::sort(result, {}, &WindowSystem::Landmark::id);
  return result;
}

// The robot's system has no absolute pose (gauge freedom): the newest keyframe is fixed, which does
// not change relative quantities.
std::optional<PoseCovariances> covariance_of_robot(const WindowSystem& system, int first) {
  const Eigen::Index held = system.H_robot.rows() - 6;
  const Eigen::LLT<Eigen::MatrixXd> cholesky(system.H_robot.topLeftCorner(held, held));
  if (cholesky.info() != Eigen::Success) return std::nullopt;
  const Eigen::Index size = held - Eigen::Index{6} * first;
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(size + 6, size + 6);
  covariance.topLeftCorner(size, size) = last_of_inverse(cholesky, size);
  if (!covariance.allFinite()) return std::nullopt;
  return PoseCovariances(std::move(covariance), first);
}

std::optional<PoseCovariances> covariance_with_map(const WindowSystem& system, int first) {
  if (system.cholesky.info() != Eigen::Success) return std::nullopt;
  Eigen::MatrixXd covariance =
      last_of_inverse(system.cholesky, system.H_robot.rows() - Eigen::Index{6} * first);
  if (!covariance.allFinite()) return std::nullopt;
  return PoseCovariances(std::move(covariance), first);
}

// What `covariances` gained, with inflation and floors. In units of the floors the covariance along
// an eigenvector of the gain becomes inflation / gain + 1.
template <int N>
Eigen::Matrix<double, N, N> information_to_send(
    const RelativeMarginals::Covariances<N>& covariances,
    const Eigen::Matrix<double, N, 1>& floors,
    double inflation) {
  using Matrix = Eigen::Matrix<double, N, N>;
  const Matrix gained = floors.asDiagonal() *
                        (covariances.with_map.inverse() - covariances.without_map.inverse()) *
                        floors.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(0.5 * (gained + gained.transpose()));
  const Eigen::Matrix<double, N, 1> weights = eigen.eigenvalues().unaryExpr(
      [&](double value) { return value > 0.0 ? value / (inflation + value) : 0.0; });
  const Matrix axes = floors.cwiseInverse().asDiagonal() * eigen.eigenvectors();
  return axes * weights.asDiagonal() * axes.transpose();
}

}  // namespace

template <int N>
double RelativeMarginals::Covariances<N>::gain() const {
  return 0.5 * std::log(without_map.determinant() / with_map.determinant());
}
template struct RelativeMarginals::Covariances<3>;
template struct RelativeMarginals::Covariances<6>;

int correctable_keyframes(Duration interval, Duration round_trip, const CorrectionConfig& config) {
  if (interval <= Duration::zero()) return 0;  // stamps are what a robot says
  const double newer = to_seconds(round_trip) / to_seconds(interval);
  if (newer >= config.robot_window) return 0;
  return std::min(config.keyframes, config.robot_window - static_cast<int>(newer));
}

std::optional<RelativeMarginals> relative_marginals(const WindowSystem& system,
                                                    int keyframes,
                                                    const CorrectionConfig& config) {
  const auto count = static_cast<int>(system.keyframes.size());
  const int first = std::max(0, count - keyframes);
  const auto landmarks = candidates(system, first, config);
  int oldest = first;
  for (const auto* landmark : landmarks) oldest = std::min(oldest, oldest_observer(*landmark));
  const auto without_map = covariance_of_robot(system, oldest);
  const auto with_map = covariance_with_map(system, oldest);
  if (!without_map || !with_map) return std::nullopt;

  RelativeMarginals result;
  result.anchor = system.keyframes.back();
  for (int to = first + 1; to < count; ++to) {
    const auto index = static_cast<std::size_t>(to);
    const Pose T = inverse(system.T_map_body[index - 1]) * system.T_map_body[index];
    result.relative_poses.push_back({system.keyframes[index - 1],
                                     system.keyframes[index],
                                     T,
                                     {without_map->of_relative_pose(to - 1, to, T),
                                      with_map->of_relative_pose(to - 1, to, T)}});
  }
  const Pose& T_map_anchor = system.T_map_body.back();
  for (const auto* landmark : landmarks) {
    result.landmarks.push_back(
        {landmark->id,
         inverse(T_map_anchor) * landmark->p_map,
         {without_map->of_anchored_landmark(*landmark, landmark->H_robot, T_map_anchor),
          with_map->of_anchored_landmark(*landmark, landmark->equations.H, T_map_anchor)}});
  }
  return result;
}

Correction map_correction(const RelativeMarginals& marginals, const CorrectionConfig& config) {
  Correction correction;
  correction.anchor = marginals.anchor;
  Vector6d pose_floors;
  pose_floors << Eigen::Vector3d::Constant(config.pose_floor_rad),
      Eigen::Vector3d::Constant(config.pose_floor_m);
  for (const auto& pair : marginals.relative_poses) {
    if (!(pair.covariances.gain() >= config.min_gain)) continue;
    correction.relative_poses.push_back(
        {pair.from,
         pair.to,
         pair.T_from_to,
         information_to_send<6>(pair.covariances, pose_floors, config.pose_inflation)});
  }

  std::vector<std::pair<double, const RelativeMarginals::Landmark*>> chosen;
  for (const auto& landmark : marginals.landmarks) {
    const double gain = landmark.covariances.gain();
    if (gain >= config.min_gain) chosen.emplace_back(gain, &landmark);
  }
  std::ranges::stable_sort(chosen, [](const auto& a, const auto& b) { return a.first > b.first; });
  const auto max_count = static_cast<std::size_t>(config.max_landmarks);
  if (chosen.size() > max_count) chosen.resize(max_count);
  const Eigen::Vector3d floors = Eigen::Vector3d::Constant(config.landmark_floor_m);
  for (const auto& [gain, landmark] : chosen) {
    correction.landmarks.push_back(
        {landmark->id,
         landmark->p_anchor,
         information_to_send<3>(landmark->covariances, floors, config.landmark_inflation)});
  }
  std::ranges::sort(correction.landmarks, {}, &Correction::Landmark::id);
  return correction;
}

CorrectionConfig read_correction_config(ConfigReader section) {
  return {.keyframes = section.integer("keyframes", 2, 17),
          .robot_window = section.integer("robot_window", 2, 100),
          .max_landmarks = section.integer("max_landmarks", 0, 128),
          .max_landmark_sigma_m = section.positive("max_landmark_sigma_m"),
          .min_gain = section.positive("min_gain"),
          .pose_floor_rad = section.positive("pose_floor_rad"),
          .pose_floor_m = section.positive("pose_floor_m"),
          .landmark_floor_m = section.positive("landmark_floor_m"),
          .pose_inflation = section.positive("pose_inflation"),
          .landmark_inflation = section.positive("landmark_inflation")};
}

}  // namespace fleetloc
