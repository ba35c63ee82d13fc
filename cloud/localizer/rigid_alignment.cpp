#include "cloud/localizer/rigid_alignment.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "cloud/localizer/degeneracy.hpp"
#include "cloud/localizer/evenly.hpp"
#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

constexpr double kMaxScore = 9.0;    // of a landmark: three sigmas, squared
constexpr double kMaxSteps = 8.0;    // of starts along an axis, to either side
constexpr double kSamePlace = 0.05;  // [m, rad]

// A turn about `center_map`, then a shift.
Pose motion_of(const Eigen::Vector3d& theta,
               const Eigen::Vector3d& t,
               const Eigen::Vector3d& center_map) {
  const Eigen::Quaterniond R = exp_so3(theta);
  return {R, center_map - R * center_map + t};
}

// The prior itself, and both directions along the principal axes of its yaw, x and y: a robot that
// has driven on from a start that was turned is off sideways as well. They are as dense as the gate
// is wide, up to a number of them.
std::vector<Pose> starts_around(const PoseWithCovariance& prior,
                                double lever_m,
                                double sigmas,
                                double gate_m) {
  const Matrix6d map_axes = adjoint({prior.T_map_body.R, Eigen::Vector3d::Zero()});
  const Matrix6d covariance = map_axes * prior.covariance * map_axes.transpose();
  const Eigen::DiagonalMatrix<double, 3> scale(lever_m, 1.0, 1.0);
  const Eigen::Matrix3d planar = scale * covariance.block<3, 3>(2, 2) * scale;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(planar);
  std::vector<Pose> starts{Pose{}};
  for (int axis = 0; axis < 3; ++axis) {
    const double reach_m = sigmas * std::sqrt(std::max(0.0, axes.eigenvalues()(axis)));
    const int steps = static_cast<int>(std::clamp(std::ceil(reach_m / gate_m), 1.0, kMaxSteps));
    for (int step = -steps; step <= steps; ++step) {
      if (step == 0) continue;
      const Eigen::Vector3d moved = reach_m * step / steps * axes.eigenvectors().col(axis);
      const Eigen::Vector3d yaw = moved(0) / lever_m * Eigen::Vector3d::UnitZ();
      starts.push_back(motion_of(yaw, {moved(1), moved(2), 0.0}, prior.T_map_body.p));
    }
  }
  return starts;
}

struct System {
  Matrix6d H = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();

  void add(const Vector6d& J, double error, double weight) {
    H += weight * J * J.transpose();
    g += weight * error * J;
  }
};

void add_match(const MapMatch& match,
               const WindowMotion& motion,
               const RigidAlignment::Config& config,
               System& s) {
  const Eigen::Vector3d d = match.landmark.p_map - match.q_map;
  const double sigma = match.sigma_m * match.widening;
  const auto add = [&](const Eigen::Vector3d& direction) {
    const double variance = sigma * sigma + direction.dot(match.landmark.covariance * direction);
    const double error = direction.dot(d);
    const double sigmas = error / (config.kernel * std::sqrt(variance));
    const double robust = 1.0 / (1.0 + sigmas * sigmas);
    const bool is_before = error * direction.dot(match.landmark.viewpoint_map - match.q_map) > 0.0;
    const double likely = match.is_level && is_before ? config.lifted_weight : 1.0;
    s.add(motion.gradient(direction, match.landmark.p_map), error, likely * robust / variance);
  };
  if (match.is_planar) return add(match.normal);
  for (int axis = 0; axis < 3; ++axis) add(Eigen::Vector3d::Unit(axis));
}

// The level direction in which a shift is the least certain, by the information of a turn and a
// shift.
Eigen::Vector3d weakest_shift(const Matrix6d& information) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(
      information.inverse().block<2, 2>(3, 3));
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  direction.head<2>() = eigen.eigenvectors().col(1);
  return direction;
}

}  // namespace

std::vector<WindowLandmark> moved(std::vector<WindowLandmark> landmarks, const Pose& T_new_old) {
  const Eigen::Matrix3d R = T_new_old.R.toRotationMatrix();
  for (WindowLandmark& landmark : landmarks) {
    landmark.p_map = R * landmark.p_map + T_new_old.p;
    landmark.viewpoint_map = R * landmark.viewpoint_map + T_new_old.p;
    landmark.covariance = R * landmark.covariance * R.transpose();
  }
  return landmarks;
}

RigidAlignment::Result RigidAlignment::align(const std::vector<WindowLandmark>& landmarks,
                                             const PoseWithCovariance& prior,
                                             const Gates& gates,
                                             const std::optional<Pose>& guess) const {
  Run run(*this, landmarks, prior, gates, guess);
  while (run.advance()) continue;
  return run.result();
}

RigidAlignment::Run::Run(const RigidAlignment& alignment,
                         const std::vector<WindowLandmark>& landmarks,
                         const PoseWithCovariance& prior,
                         const Gates& gates,
                         const std::optional<Pose>& guess)
    : alignment_(alignment),
      landmarks_(evenly(landmarks, alignment.config_.max_landmarks)),
      prior_(prior),
      gates_(gates) {
  if (landmarks_.empty()) return;
  std::vector<Eigen::Vector3d> positions;
  positions.reserve(landmarks_.size());
  for (const WindowLandmark& landmark : landmarks_) positions.push_back(landmark.p_map);
  const double lever_m = lever(positions, prior.T_map_body.p);
  starts_ = starts_around(prior, lever_m, alignment.config_.start_sigmas, gates.first_m);
  if (guess) starts_.push_back(*guess);
}

bool RigidAlignment::Run::advance() {
  if (!has_rivals_ && results_.size() == starts_.size()) add_rivals();
  if (results_.size() == starts_.size()) return false;
  const double final_m = gates_.final_m;
  const Gates near{alignment_.association_.gate_sigmas * final_m, final_m};
  results_.push_back(alignment_.descend(
      landmarks_, prior_, has_rivals_ ? near : gates_, starts_[results_.size()]));
  return true;
}

// Places beside the best one are looked for where the map holds the window least.
void RigidAlignment::Run::add_rivals() {
  has_rivals_ = true;
  if (results_.empty()) return;
  const Config& config = alignment_.config_;
  const Aligned& best = *std::ranges::min_element(results_, {}, &Aligned::score);
  const Eigen::Vector3d step_map = config.rival_step_m * weakest_shift(best.information);
  for (int step = -config.rival_steps; step <= config.rival_steps; ++step) {
    if (step != 0) starts_.push_back({best.T_new_old.R, best.T_new_old.p + step * step_map});
  }
}

RigidAlignment::Result RigidAlignment::Run::result() {
  if (results_.empty()) return {};
  std::ranges::sort(results_, {}, &Aligned::score);
  const Aligned& chosen = results_.front();
  const Matrix6d rivals = alignment_.rivals_of(results_, prior_.T_map_body);
  return {chosen.T_new_old, chosen.score, rivals};
}

// Of starts that have come to one place only the best one counts.
// @param results  sorted by score: the first one is chosen
Matrix6d RigidAlignment::rivals_of(const std::vector<Aligned>& results,
                                   const Pose& T_old_body) const {
  const Aligned& best = results.front();
  const Pose chosen = best.T_new_old * T_old_body;
  std::vector<Pose> places;
  double odds_of_all = 0.0;
  Matrix6d sum = Matrix6d::Zero();
  for (const Aligned& result : results) {
    const Pose place = result.T_new_old * T_old_body;
    const auto is_there = [&](const Pose& other) {
      return local_coordinates(other, place).norm() < kSamePlace;
    };
    if (std::ranges::any_of(places, is_there)) continue;
    places.push_back(place);
    const Vector6d beside = local_coordinates(chosen, place);
    const double odds = std::exp((best.score - result.score) / config_.rival_score);
    odds_of_all += odds;
    sum += odds * beside * beside.transpose();
  }
  return sum / odds_of_all;
}

RigidAlignment::Aligned RigidAlignment::descend(const std::vector<WindowLandmark>& landmarks,
                                                const PoseWithCovariance& prior,
                                                const Gates& gates,
                                                const Pose& start) const {
  const Matrix6d prior_information = prior.covariance.inverse();
  const double shrink = std::pow(gates.final_m / gates.first_m, 1.0 / config_.iterations);
  Aligned result{start};
  double gate_m = gates.first_m;
  for (int i = 0; i < config_.iterations; ++i, gate_m *= shrink) {
    const auto placed = moved(landmarks, result.T_new_old);
    const Pose T_map_body = result.T_new_old * prior.T_map_body;
    const WindowMotion motion{T_map_body.p, 1.0};
    System system;
    for (const MapMatch& match : associate(placed, map_, gate_m, association_).matches) {
      add_match(match, motion, config_, system);
    }
    const Vector6d error = local_coordinates(prior.T_map_body, T_map_body);
    const Matrix6d J = right_jacobian_inverse_se3(error) * motion.J_body_motion(T_map_body);
    system.H += J.transpose() * prior_information * J;
    system.g += J.transpose() * prior_information * error;
    const Vector6d step = -system.H.ldlt().solve(system.g);
    result.T_new_old =
        motion_of(step.head<3>(), step.tail<3>(), motion.center_map) * result.T_new_old;
    result.information = system.H;
  }
  result.score = score(landmarks, prior, gates.final_m, result.T_new_old);
  return result;
}

double RigidAlignment::score(const std::vector<WindowLandmark>& landmarks,
                             const PoseWithCovariance& prior,
                             double gate_m,
                             const Pose& T_new_old) const {
  const Association found = associate(moved(landmarks, T_new_old), map_, gate_m, association_);
  // A landmark without a match costs the maximum, one below ground twice that.
  double sum = kMaxScore * (static_cast<double>(found.eligible + found.below_ground) -
                            static_cast<double>(found.matches.size()));
  for (const MapMatch& match : found.matches) {
    const double error = residual(match, match.landmark.p_map);
    const Eigen::Vector3d& n = match.normal;
    const double variance = match.sigma_m * match.sigma_m + n.dot(match.landmark.covariance * n);
    sum += std::min(error * error / variance, kMaxScore);
  }
  const Vector6d moved_by = local_coordinates(prior.T_map_body, T_new_old * prior.T_map_body);
  return sum + moved_by.dot(prior.covariance.ldlt().solve(moved_by));
}

RigidAlignment::Config read_rigid_alignment_config(ConfigReader section) {
  return {.iterations = section.integer("iterations", 1, 100),
          .max_landmarks = section.integer("max_landmarks", 10, 10000),
          .start_sigmas = section.positive("start_sigmas"),
          .kernel = section.positive("kernel"),
          .lifted_weight = section.number("lifted_weight", 0.0, 1.0),
          .rival_step_m = section.positive("rival_step_m"),
          .rival_steps = section.integer("rival_steps", 0, 100),
          .rival_score = section.positive("rival_score")};
}

}  // namespace fleetloc
