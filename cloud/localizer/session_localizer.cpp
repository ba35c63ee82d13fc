#include "cloud/localizer/session_localizer.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <utility>

#include <Eigen/Cholesky>

#include "shared/core/percentile.hpp"
#include "shared/geometry/covariance.hpp"

namespace fleetloc {
namespace {

constexpr std::size_t kBytesPerObservation = 700;  // residual block, factor and their places
constexpr std::size_t kBytesPerLandmark = 900;

Matrix6d diagonal(double rotation, double translation) {
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(rotation * rotation),
      Eigen::Vector3d::Constant(translation * translation);
  return variances.asDiagonal();
}

std::optional<PoseAnchor> anchor_at_start(const RobotSession& session) {
  if (!session.start) return std::nullopt;
  const MapOdomEstimate& start = *session.start;
  Pose T_odom_known;
  T_odom_known.p = start.p_odom;
  const Matrix6d A = adjoint(inverse(T_odom_known));
  return PoseAnchor{
      .keyframe = std::nullopt,
      .T_odom_body = T_odom_known,
      .travelled_m = 0.0,
      .estimate = {start.T_map_odom * T_odom_known, A * start.covariance * A.transpose()}};
}

}  // namespace

SessionLocalizer::SessionLocalizer(const RobotSession& session,
                                   std::shared_ptr<const LaserMap> map,
                                   const Config& config)
    : map_(std::move(map)),
      config_(config),
      database_(config_.database),
      problem_(session.stereo, config_.database.window, config_.problem),
      alignment_(*map_, config_.association, config_.alignment),
      nearest_(*map_),
      start_(config_.confirmation),
      anchor_(anchor_at_start(session)),
      begin_odom_(anchor_ ? anchor_->T_odom_body.p : Eigen::Vector3d::Zero()) {}

void SessionLocalizer::add(const Submap& submap) {
  const SessionDatabase::Added added = database_.add(submap);
  added_.stored += added.stored;
  added_.repeated += added.repeated;
  added_.stale += added.stale;
  measure_path();
}

// Path length up to each new keyframe, on straight lines.
void SessionLocalizer::measure_path() {
  for (const auto& [id, keyframe] : database_.keyframes()) {
    const auto next = path_.lower_bound(id);
    if (next != path_.end() && next->first == id) continue;
    PathPoint point{.p_odom = keyframe.item.T_odom_body.p, .travelled_m = 0.0};
    if (next == path_.begin()) {
      point.travelled_m = (point.p_odom - begin_odom_).norm();
    } else {
      const PathPoint& before = std::prev(next)->second;
      point.travelled_m = before.travelled_m + (point.p_odom - before.p_odom).norm();
    }
    path_.emplace_hint(next, id, point);
  }
  const KeyframeId horizon = database_.keyframes().begin()->first;
  path_.erase(path_.begin(), path_.lower_bound(horizon));
}

LocalizationResult SessionLocalizer::localize() {
  assert(!database_.empty());
  diagnostics_ = {};
  system_.reset();
  const SubmapKeyframe newest = database_.newest().item;
  const std::vector<KeyframeId> window = database_.window();
  diagnostics_.keyframes = static_cast<int>(window.size());

  LocalizationResult answer;
  answer.keyframe = newest.id;
  answer.revision = newest.revision;
  answer.stamp = newest.stamp;
  answer.map_hash = map_->info().hash;
  PoseWithCovariance result;
  answer.status = localize_window(window, result);
  if (answer.status != LocalizationStatus::kLocalized) {
    system_.reset();
    return answer;
  }

  store(result);
  const auto& covariance_inflation = config_.covariance_inflation;
  answer.T_map_body = result.T_map_body;
  answer.covariance =
      result.covariance + diagonal(covariance_inflation.floor_rad, covariance_inflation.floor_m);
  answer.T_map_odom = result.T_map_body * inverse(newest.T_odom_body);
  return answer;
}

std::optional<Correction> SessionLocalizer::correction() const {
  if (!system_) return std::nullopt;
  const auto marginals = relative_marginals(*system_, config_.corrections);
  if (!marginals) return std::nullopt;
  Correction correction = map_correction(*marginals, config_.corrections);
  if (correction.relative_poses.empty() && correction.landmarks.empty()) return std::nullopt;
  return correction;
}

// Sets the pose and, without the floors, its covariance.
LocalizationStatus SessionLocalizer::localize_window(const std::vector<KeyframeId>& window,
                                                     PoseWithCovariance& result) {
  using enum LocalizationStatus;
  if (!anchor_) return kNoStartPose;
  if (diagnostics_.keyframes < config_.acceptance.min_keyframes) return kTooFewKeyframes;
  const Pose T_map_odom = anchor_->estimate.T_map_body * inverse(anchor_->T_odom_body);
  problem_.synchronize(database_, database_.placed(window, T_map_odom));
  nearest_.forget([this](LandmarkId landmark) { return !problem_.has(landmark); });
  diagnostics_.observations = problem_.observations();

  const PosePrior pose_prior = pose_prior_of(window);
  diagnostics_.gate_m = gate_for(pose_prior.estimate);
  if (diagnostics_.gate_m > config_.rounds.tracking_gate_m) align(pose_prior);
  if (const auto status = optimize(pose_prior); status != kLocalized) return status;
  measure_fit();
  return check_result(pose_prior, result);
}

// At the keyframe localized last; before the first localization, or once that keyframe has left the
// window, dead-reckoned to the window's oldest keyframe.
SessionLocalizer::PosePrior SessionLocalizer::pose_prior_of(
    const std::vector<KeyframeId>& window) const {
  if (anchor_->keyframe && std::ranges::binary_search(window, *anchor_->keyframe)) {
    return {*anchor_->keyframe, anchor_->estimate};
  }
  return {window.front(), predicted(window.front())};
}

// Dead-reckoned from the anchor.
PoseWithCovariance SessionLocalizer::predicted(KeyframeId keyframe) const {
  const Pose& T_odom_body = database_.keyframe(keyframe).item.T_odom_body;
  return anchor_->at(T_odom_body, path_.at(keyframe).travelled_m, config_.drift);
}

// Grows with each rejection, so that no pose is locked out for ever.
double SessionLocalizer::innovation_gate() const {
  const auto& limits = config_.acceptance;
  return limits.innovation_gate_sigmas * (1.0 + limits.innovation_gate_growth * refused_in_a_row_);
}

// By the uncertainty of the landmarks in the map that follows from that of the pose.
double SessionLocalizer::gate_for(const PoseWithCovariance& estimate) const {
  std::vector<double> distances;
  for (const auto& [id, p_map] : problem_.positions()) {
    distances.push_back((p_map - estimate.T_map_body.p).norm());
  }
  const double turned = percentile(std::move(distances), 0.5).value_or(0.0) *
                        max_sigma(estimate.covariance.topLeftCorner<3, 3>());
  const double shifted = max_sigma(estimate.covariance.bottomRightCorner<3, 3>());
  const auto& rounds = config_.rounds;
  return std::clamp(rounds.gate_sigmas * std::hypot(turned, shifted),
                    rounds.tracking_gate_m,
                    rounds.widest_gate_m);
}

void SessionLocalizer::align(const PosePrior& pose_prior) {
  const RigidAlignment::Gates gates{diagnostics_.gate_m, config_.rounds.final_gate_m};
  const PoseWithCovariance prior{problem_.pose(pose_prior.keyframe),
                                 pose_prior.estimate.covariance};
  std::optional<Pose> guess;
  if (start_.last_T_map_odom()) {
    const Pose& T_odom_body = database_.keyframe(pose_prior.keyframe).item.T_odom_body;
    guess = *start_.last_T_map_odom() * T_odom_body * inverse(prior.T_map_body);
  }
  problem_.move(alignment_.align(problem_.landmarks(), prior, gates, guess));
  diagnostics_.aligned = true;
}

LocalizationStatus SessionLocalizer::optimize(const PosePrior& pose_prior) {
  using enum LocalizationStatus;
  const auto& rounds = config_.rounds;
  const KeyframeId newest = database_.newest().item.id;
  double gate_m = rounds.tracking_gate_m;
  for (int round = 0; round < rounds.max_rounds; ++round) {
    const Pose before = problem_.pose(newest);
    if (const auto status = run_round(pose_prior, gate_m); status != kLocalized) return status;
    const double moved_m = local_coordinates(before, problem_.pose(newest)).norm();
    const bool is_final = gate_m <= rounds.final_gate_m;
    if (is_final && moved_m < rounds.settled_m) break;
    gate_m = std::max(rounds.final_gate_m, rounds.shrink * gate_m);
  }
  return kLocalized;
}

LocalizationStatus SessionLocalizer::run_round(const PosePrior& pose_prior, double gate_m) {
  using enum LocalizationStatus;
  const std::vector<WindowLandmark> landmarks = problem_.landmarks();
  association_ = associate(landmarks, *map_, gate_m, config_.association, nearest_);
  diagnostics_.landmarks = static_cast<int>(landmarks.size());
  diagnostics_.eligible = association_.eligible;
  diagnostics_.covered = association_.covered;
  diagnostics_.occluded = association_.occluded;
  diagnostics_.below_ground = association_.below_ground;
  diagnostics_.level = association_.level;
  diagnostics_.matches = static_cast<int>(association_.matches.size());
  diagnostics_.planar_matches =
      static_cast<int>(std::ranges::count_if(association_.matches, &MapMatch::is_planar));
  if (const auto status = check_matches(); status != kLocalized) return status;

  constraint_ = analyze_map_constraint(association_.matches, config_.degeneracy);
  diagnostics_.weak_directions = static_cast<int>(constraint_.weak.cols());
  diagnostics_.map_sigmas_m = constraint_.sigmas_m;
  set_prior(pose_prior);
  problem_.set_matches(association_.matches);
  const WindowProblem::Solved solved = problem_.solve(config_.rounds.iterations);
  ++diagnostics_.rounds;
  diagnostics_.iterations += solved.iterations;
  diagnostics_.cost = solved.cost;
  return solved.is_usable ? kLocalized : kNotConverged;
}

// Until the first solution the start pose is a prior in all directions; afterwards the pose found
// before is one along weak directions only.
void SessionLocalizer::set_prior(const PosePrior& pose_prior) {
  problem_.clear_prior();
  const double min_sigma_m = config_.covariance_inflation.min_prior_sigma_m;
  if (!anchor_->keyframe) {
    const Matrix6d information = pose_prior.estimate.covariance.inverse();
    problem_.set_prior(pose_prior.keyframe, pose_prior.estimate.T_map_body, information);
  } else if (constraint_.weak.cols() > 0) {
    const Matrix6d information =
        information_along(constraint_.weak, constraint_.motion, pose_prior.estimate, min_sigma_m);
    problem_.set_prior(pose_prior.keyframe, pose_prior.estimate.T_map_body, information);
  }
}

void SessionLocalizer::measure_fit() {
  const LandmarkPositions positions = problem_.positions();
  std::vector<double> residuals;
  for (const MapMatch& match : association_.matches) {
    const double error = residual(match, positions.at(match.landmark.id));
    const auto& association = config_.association;
    residuals.push_back(match.is_planar ? std::abs(error) / association.plane_sigma_m
                                        : error / (std::sqrt(3.0) * association.point_sigma_m));
  }
  diagnostics_.median_residual = percentile(std::move(residuals), 0.5).value_or(0.0);
}

LocalizationStatus SessionLocalizer::check_result(const PosePrior& pose_prior,
                                                  PoseWithCovariance& result) {
  using enum LocalizationStatus;
  const auto& limits = config_.acceptance;
  const SubmapKeyframe& newest = database_.newest().item;
  result.T_map_body = problem_.pose(newest.id);

  if (diagnostics_.median_residual > limits.max_median_residual) return kPoorFit;
  if (is_under_ground()) return kPoorFit;

  PoseWithCovariance expected = predicted(newest.id);
  expected.covariance += diagonal(limits.innovation_floor_rad, limits.innovation_floor_m);
  const Vector6d moved = local_coordinates(expected.T_map_body, result.T_map_body);
  diagnostics_.moved_sigmas = std::sqrt(moved.dot(expected.covariance.ldlt().solve(moved)));
  if (!(diagnostics_.moved_sigmas <= innovation_gate())) {
    if (anchor_->keyframe) ++refused_in_a_row_;
    return kNotConverged;
  }

  system_ = problem_.system();
  const std::optional<Matrix6d> covariance = system_->covariance_of_newest();
  if (!covariance) return kDegenerate;
  result.covariance =
      config_.covariance_inflation.scale * config_.covariance_inflation.scale * *covariance;
  if (!add_weak_directions(pose_prior, result)) return kDegenerate;
  const double travelled_m = path_.at(newest.id).travelled_m;
  return start_.take(result.T_map_body, newest.T_odom_body, travelled_m, is_confident())
             ? kLocalized
             : kUnconfirmed;
}

// Along weak directions the answer is as uncertain as the prior grown by the odometry since; false
// if that is too much.
bool SessionLocalizer::add_weak_directions(const PosePrior& pose_prior,
                                           PoseWithCovariance& result) const {
  if (constraint_.weak.cols() == 0) return true;
  const KeyframeId newest = database_.newest().item.id;
  const std::optional<Matrix6d> growth = problem_.covariance_from(pose_prior.keyframe, newest);
  if (!growth) return false;
  const Pose step = inverse(problem_.pose(pose_prior.keyframe)) * result.T_map_body;
  const Matrix6d A = adjoint(inverse(step));
  const Matrix6d min_covariance = A * pose_prior.estimate.covariance * A.transpose() + *growth;
  result.covariance = widened_along(constraint_.weak, constraint_.motion, result, min_covariance);
  const Matrix6d J = constraint_.motion.J_body_motion(result.T_map_body).inverse();
  const Eigen::MatrixXd weak = constraint_.weak.transpose() * J;
  const Eigen::MatrixXd covariance = weak * result.covariance * weak.transpose();
  const double worst = covariance.diagonal().maxCoeff();
  return worst <= config_.acceptance.max_weak_sigma_m * config_.acceptance.max_weak_sigma_m;
}

void SessionLocalizer::store(const PoseWithCovariance& result) {
  for (const auto& [id, T_map_body] : problem_.poses()) database_.store_solution(id, T_map_body);
  for (const auto& [id, p_map] : problem_.positions()) database_.store_solution(id, p_map);
  const SubmapKeyframe& newest = database_.newest().item;
  anchor_ = {.keyframe = newest.id,
             .T_odom_body = newest.T_odom_body,
             .travelled_m = path_.at(newest.id).travelled_m,
             .estimate = result};
  refused_in_a_row_ = 0;
}

std::size_t SessionLocalizer::memory_bytes() const {
  const auto observations = static_cast<std::size_t>(problem_.observations());
  return sizeof(*this) + database_.memory_bytes() + observations * kBytesPerObservation +
         database_.landmarks().size() * kBytesPerLandmark + nearest_.memory_bytes() +
         (system_ ? system_->memory_bytes() : 0);
}

}  // namespace fleetloc
