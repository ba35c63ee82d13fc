#include "robot/fusion/map_alignment.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "robot/fusion/map_tilt.hpp"
#include "shared/geometry/angle.hpp"
#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

// Covariance of T_map_odom if roll and pitch, about a point that stays where it is, have this
// sigma.
Matrix6d tilt_about(const Eigen::Vector3d& p_odom, double sigma) {
  Eigen::Matrix<double, 6, 2> J;
  J << Eigen::Matrix<double, 3, 2>::Identity(), hat(p_odom).leftCols<2>();
  return sigma * sigma * J * J.transpose();
}

}  // namespace

MapAlignment::MapAlignment(const Config& config)
    : config_(config), hypotheses_(config.hypotheses) {}

void MapAlignment::drift(const DriftStep& step) {
  if (last_applied_) {
    P_.topLeftCorner<6, 6>() += step.covariance;
    metres_since_error_ += step.metres;
    standstill_ += step.standstill;
    hypotheses_.drift(step.covariance);
  }
}

std::optional<MapOdomEstimate> MapAlignment::pose() const {
  if (!last_applied_) {
    return std::nullopt;
  }
  return MapOdomEstimate{T_map_odom_, P_.topLeftCorner<6, 6>()};
}

std::optional<MapOdomEstimate> MapAlignment::session_start() const {
  const std::optional<MapOdomEstimate> estimate = pose();
  return estimate ? std::optional(hypotheses_.inflated(*estimate)) : std::nullopt;
}

// Uses the answer and gravity only: d = -Ad(T_odom_body) * (J_error * u + white).
AnswerOutcome MapAlignment::initialize(const LocalizationMeasurement& answer, AnswerEffect effect) {
  const Pose T_map_odom = alignment_from(answer);
  const Matrix6d covariance = alignment_covariance(answer);
  const MapTilt tilt = tilt_of(T_map_odom.R);
  if (chi_square(tilt, covariance, config_.map_tilt) > config_.tilt_gate_chi_square) {
    return unexpected(FusionRejection::kImplausibleTilt);
  }
  T_map_odom_ = T_map_odom;
  error_.setZero();
  P_.topLeftCorner<6, 6>() = covariance;
  P_.topRightCorner<6, 6>() = -adjoint(answer.T_odom_body) * answer.J_error;
  P_.bottomLeftCorner<6, 6>() = P_.topRightCorner<6, 6>().transpose();
  P_.bottomRightCorner<6, 6>().setIdentity();

  Eigen::Matrix<double, 2, 12> H = Eigen::Matrix<double, 2, 12>::Zero();
  H.leftCols<3>() = tilt.J_rotation;
  update<2>(-tilt.value, H, config_.map_tilt * config_.map_tilt * Eigen::Matrix2d::Identity());
  map_hash_ = answer.map_hash;
  error_stamp_ = answer.stamp;
  error_oldest_stamp_ = answer.oldest_stamp;
  error_p_map_body_ = answer.T_map_body.p;
  error_root_ = answer.root_map;
  metres_since_error_ = 0.0;
  last_applied_ = answer.stamp;
  standstill_ = {};
  continued_ = false;
  hypotheses_.restart(answer);
  return effect;
}

MapAlignment MapAlignment::continued(const MapOdomEstimate& pose) const {
  MapAlignment result(config_);
  if (last_applied_) {
    result.map_hash_ = map_hash_;
    result.last_applied_ = last_applied_;
    result.standstill_ = standstill_;
    result.T_map_odom_ = pose.T_map_odom;
    result.P_.topLeftCorner<6, 6>() = pose.covariance + tilt_about(pose.p_odom, config_.map_tilt);
    result.hypotheses_ = hypotheses_.without_alternatives();
    result.continued_ = true;
  }
  return result;
}

// Both errors as if independent, which is conservative: they are positively correlated.
bool MapAlignment::agrees_with_continued(const LocalizationMeasurement& answer) const {
  const Vector6d residual = local_coordinates(T_map_odom_ * answer.T_odom_body, answer.T_map_body);
  const Matrix6d S =
      answer.J_alignment * P_.topLeftCorner<6, 6>() * answer.J_alignment.transpose() +
      answer.covariance;
  return chi_square(residual, S) <= config_.gate_chi_square;
}

// Share of the shorter window that is in both: that of an answer, and that of the earlier one that
// u belongs to. If each keyframe brings an error of its own and an answer has their mean, the
// answers of n and N >= n keyframes, m of them common, have the covariance sigma^2 m / (n N): m / n
// times that of the better answer.
double MapAlignment::shared_window(const LocalizationMeasurement& answer) const {
  assert(answer.stamp >= error_stamp_);
  const Duration shared = error_stamp_ - std::max(answer.oldest_stamp, error_oldest_stamp_);
  const Duration shorter =
      std::min(answer.stamp - answer.oldest_stamp, error_stamp_ - error_oldest_stamp_);
  if (shared >= shorter) return 1.0;
  return std::max(0.0, to_seconds(shared) / to_seconds(shorter));
}

// u becomes F * u.
void MapAlignment::transform_error(const Matrix6d& F) {
  error_ = F * error_;
  P_.rightCols<6>() *= F.transpose();
  P_.bottomRows<6>() = F * P_.bottomRows<6>().eval();
}

// u becomes the same error, normalized by another root: error * u is root * u'.
void MapAlignment::normalize_error(const Matrix6d& error, const Matrix6d& root) {
  transform_error(root.ldlt().solve(error));
  error_root_ = root;
}

// A wrong place is a rigid motion of the whole window: at the body's next place, its rotation has
// another lever arm.
void MapAlignment::carry_error_to(const Eigen::Vector3d& p_map_body) {
  const Pose lever{Eigen::Quaterniond::Identity(), error_p_map_body_ - p_map_body};
  const Matrix6d error = adjoint(lever) * error_root_;
  normalize_error(error, symmetric_root(error * error.transpose()));
  error_p_map_body_ = p_map_body;
}

// An answer whose window contains the earlier one's, or that looks at the same from the same place,
// cannot be less certain. Where it is, the earlier one was too certain, as along a direction that
// the map hardly constrains and that turns as more is seen of it: its error becomes that uncertain,
// and with it what T_map_odom has of it. Otherwise two such answers would cross at a point.
void MapAlignment::widen_error(const LocalizationMeasurement& answer) {
  const bool contains = reaches_back_to(error_oldest_stamp_, answer);
  if (!contains && metres_since_error_ > config_.same_view_m) return;
  const Matrix6d J = error_root_.ldlt().solve(answer.root_map);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(J * J.transpose());
  const Matrix6d& V = eigen.eigenvectors();
  const Vector6d widened = eigen.eigenvalues().cwiseMax(1.0);
  Eigen::Matrix<double, 12, 6> by_error;
  by_error << P_.bottomRightCorner<6, 6>().ldlt().solve(P_.bottomLeftCorner<6, 6>()).transpose(),
      Matrix6d::Identity();
  const Eigen::Matrix<double, 12, 6> along = by_error * V;
  P_ += along * (widened - Vector6d::Ones()).asDiagonal() * along.transpose();
  const Matrix6d error = error_root_ * V;
  normalize_error(error_root_, symmetric_root(error * widened.asDiagonal() * error.transpose()));
}

// Transition of u from the answer that it belongs to, to a later one. Their windows overlap, so the
// answer with the smaller covariance contains the information of the other: the covariance of their
// errors is the smaller one (as in a filter, where cov(e_k, e_j) = cov(e_k) for j < k), not the
// product of their sigmas. Along common eigenvectors that is the smaller eigenvalue. As one error
// scaled by two sigmas, it would be observable from the difference of the answers.
Matrix6d MapAlignment::error_transition(const LocalizationMeasurement& answer) const {
  const double correlation = std::max(
      shared_window(answer), std::exp(-metres_since_error_ / config_.correlation_distance_m));
  const Matrix6d J = error_root_.ldlt().solve(answer.root_map);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(J * J.transpose());
  const Matrix6d shared = eigen.eigenvectors() * eigen.eigenvalues().cwiseMin(1.0).asDiagonal() *
                          eigen.eigenvectors().transpose();
  return correlation * answer.root_map.ldlt().solve(error_root_ * shared);
}

void MapAlignment::age_error(const LocalizationMeasurement& answer) {
  carry_error_to(answer.T_map_body.p);
  widen_error(answer);
  const Matrix6d F = error_transition(answer);
  transform_error(F);
  P_.bottomRightCorner<6, 6>() += Matrix6d::Identity() - F * F.transpose();
  error_stamp_ = answer.stamp;
  error_oldest_stamp_ = answer.oldest_stamp;
  error_root_ = answer.root_map;
  metres_since_error_ = 0.0;
}

// Joseph's form. The change of the tangent space by the correction is left out (second order).
template <int N>
void MapAlignment::update(const Eigen::Matrix<double, N, 1>& residual,
                          const Eigen::Matrix<double, N, 12>& H,
                          const Eigen::Matrix<double, N, N>& R) {
  const Eigen::Matrix<double, 12, N> C = P_ * H.transpose();  // of state and residual
  const Eigen::Matrix<double, N, N> S = H * C + R;
  const Eigen::Matrix<double, 12, N> K = S.llt().solve(C.transpose()).transpose();
  const Eigen::Matrix<double, 12, 1> correction = K * residual;
  const Matrix12d A = Matrix12d::Identity() - K * H;
  P_ = A * P_ * A.transpose() + K * R * K.transpose();
  T_map_odom_ = retract(T_map_odom_, correction.template head<6>());
  error_ += correction.template tail<6>();
}

AnswerOutcome MapAlignment::apply_to_continued(const LocalizationMeasurement& answer) {
  if (agrees_with_continued(answer)) return initialize(answer, AnswerEffect::kApplied);
  if (!hypotheses_.add(answer)) return unexpected(FusionRejection::kGated);
  return initialize(answer, AnswerEffect::kRestarted);
}

AnswerOutcome MapAlignment::apply(const LocalizationMeasurement& answer) {
  if (!last_applied_) return initialize(answer, AnswerEffect::kApplied);
  if (answer.map_hash != map_hash_) return unexpected(FusionRejection::kWrongMap);
  if (continued_) return apply_to_continued(answer);
  const MapAlignment before = *this;
  age_error(answer);
  Eigen::Matrix<double, 6, 12> H;
  H << answer.J_alignment, answer.J_error;
  const Vector6d residual = local_coordinates(T_map_odom_ * answer.T_odom_body, answer.T_map_body) -
                            answer.J_error * error_;
  const Matrix6d S = H * P_ * H.transpose() + answer.white;
  if (chi_square(residual, S) > config_.gate_chi_square) {
    *this = before;
    if (!hypotheses_.add(answer)) return unexpected(FusionRejection::kGated);
    return initialize(answer, AnswerEffect::kRestarted);
  }
  const Matrix6d place_before =
      answer.J_alignment * P_.topLeftCorner<6, 6>() * answer.J_alignment.transpose();
  update<6>(residual, H, answer.white);
  last_applied_ = answer.stamp;
  standstill_ = {};
  hypotheses_.support(answer, place_before);
  return AnswerEffect::kApplied;
}

MapAlignment::Config read_map_alignment_config(ConfigReader section) {
  MapAlignment::Config config;
  config.correlation_distance_m = section.positive("correlation_distance_m");
  config.same_view_m = section.positive("same_view_m");
  config.noise.white_share = section.positive("white_share");
  if (config.noise.white_share > 1.0) {
    throw ConfigError("fusion.answers.white_share: must be at most 1");
  }
  config.noise.clone_rotation = kRadPerDeg * section.positive("clone_rotation_deg");
  config.noise.clone_translation = section.positive("clone_translation_m");
  config.gate_chi_square = section.positive("gate_chi_square");
  config.map_tilt = kRadPerDeg * section.positive("map_tilt_deg");
  config.tilt_gate_chi_square = section.positive("tilt_gate_chi_square");
  config.hypotheses.gate_chi_square = config.gate_chi_square;
  config.hypotheses.lost_after = section.integer("lost_after", 1, 1000);
  config.hypotheses.restart_after = section.integer("restart_after", 1, 1000);
  return config;
}

}  // namespace fleetloc
