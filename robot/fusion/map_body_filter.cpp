#include "robot/fusion/map_body_filter.hpp"

#include <Eigen/Cholesky>

#include "robot/fusion/imu_prediction.hpp"
#include "robot/fusion/map_tilt.hpp"
#include "shared/geometry/so3.hpp"

namespace fleetloc {

MapBodyFilter::MapBodyFilter(const MapAlignment::Config& config)
    : config_(config), hypotheses_(config.hypotheses) {}

std::optional<MapOdomEstimate> MapBodyFilter::session_start() const {
  if (!last_applied_) {
    return std::nullopt;
  }
  return hypotheses_.inflated({T_map_odom_, P_.bottomRightCorner<6, 6>()});
}

// With the errors a of the answer, n of the odometry's pose, v of its velocity and b of the biases:
// body = a, T_map_odom = Ad(T_odom_body) (a - n), velocity = R_map_odom (v - hat(v_odom) rotation).
AnswerOutcome MapBodyFilter::initialize(const LocalizationMeasurement& answer,
                                        const OdometryEstimate& odometry,
                                        AnswerEffect effect) {
  const Pose T_map_odom = alignment_from(answer);
  if (chi_square(tilt_of(T_map_odom.R), alignment_covariance(answer), config_.map_tilt) >
      config_.tilt_gate_chi_square) {
    return unexpected(FusionRejection::kImplausibleTilt);
  }
  T_map_odom_ = T_map_odom;
  state_ = odometry.state;
  state_.T_odom_body = answer.T_map_body;
  state_.v_odom = T_map_odom.R * odometry.state.v_odom;

  const Matrix6d clone = clone_covariance(config_.noise);
  const Matrix6d A = adjoint(answer.T_odom_body);
  const Eigen::Matrix3d R = T_map_odom.R.toRotationMatrix();
  Eigen::Matrix<double, 21, 6> J_answer = Eigen::Matrix<double, 21, 6>::Zero();
  J_answer.topRows<6>().setIdentity();
  J_answer.bottomRows<6>() = A;
  J_answer.middleRows<3>(6) = -R * hat(odometry.state.v_odom) * A.topRows<3>();
  Eigen::Matrix<double, 21, 6> J_clone = -J_answer;
  J_clone.topRows<6>().setZero();
  P_ = J_answer * (answer.covariance - clone) * J_answer.transpose() +
       J_clone * clone * J_clone.transpose();
  P_.block<3, 3>(6, 6) += R * odometry.covariance.block<3, 3>(6, 6) * R.transpose();
  P_.block<6, 6>(9, 9) += odometry.covariance.bottomRightCorner<6, 6>();
  map_hash_ = answer.map_hash;
  last_applied_ = answer.stamp;
  hypotheses_.restart(answer);
  return effect;
}

void MapBodyFilter::propagate(const Preintegration& step, const DriftStep& drift) {
  if (!last_applied_) {
    return;
  }
  ImuPrediction prediction;
  prediction.state = state_;
  advance(prediction, step);
  state_ = prediction.state;
  const Matrix15d& F = prediction.transition;
  P_.topLeftCorner<15, 15>() =
      (F * P_.topLeftCorner<15, 15>() * F.transpose() + prediction.noise).eval();
  P_.topRightCorner<15, 6>() = (F * P_.topRightCorner<15, 6>()).eval();
  P_.bottomLeftCorner<6, 15>() = P_.topRightCorner<15, 6>().transpose();
  P_.bottomRightCorner<6, 6>() += drift.covariance;
  hypotheses_.drift(drift.covariance);
}

void MapBodyFilter::correct(const Pose& T_odom_body) {
  if (!last_applied_) {
    return;
  }
  const Pose predicted = inverse(T_map_odom_) * state_.T_odom_body;
  Matrix6x21d H = Matrix6x21d::Zero();
  H.leftCols<6>().setIdentity();
  H.rightCols<6>() = -adjoint(inverse(predicted));
  update(local_coordinates(predicted, T_odom_body), H, clone_covariance(config_.noise));
}

AnswerOutcome MapBodyFilter::apply(const LocalizationMeasurement& answer,
                                   const OdometryEstimate& odometry) {
  if (!last_applied_) return initialize(answer, odometry, AnswerEffect::kApplied);
  if (answer.map_hash != map_hash_) return unexpected(FusionRejection::kWrongMap);
  const Vector6d residual = local_coordinates(state_.T_odom_body, answer.T_map_body);
  const Matrix6d R = answer.covariance - clone_covariance(config_.noise);
  const Matrix6d before = P_.topLeftCorner<6, 6>();
  if (chi_square(residual, before + R) > config_.gate_chi_square) {
    if (!hypotheses_.add(answer)) return unexpected(FusionRejection::kGated);
    return initialize(answer, odometry, AnswerEffect::kRestarted);
  }
  Matrix6x21d H = Matrix6x21d::Zero();
  H.leftCols<6>().setIdentity();
  update(residual, H, R);
  last_applied_ = answer.stamp;
  hypotheses_.support(answer, before);
  return AnswerEffect::kApplied;
}

// P - K S K^T with K S = P H^T. The change of the tangent space by the correction is left out
// (second order).
void MapBodyFilter::update(const Vector6d& residual, const Matrix6x21d& H, const Matrix6d& R) {
  const Matrix6x21d C = H * P_;  // of residual and state
  const Eigen::LLT<Matrix6d> S(C * H.transpose() + R);
  const Eigen::Matrix<double, 21, 1> correction = C.transpose() * S.solve(residual);
  const Matrix6x21d root = S.matrixL().solve(C);
  P_ -= root.transpose() * root;
  state_.T_odom_body = retract(state_.T_odom_body, correction.head<6>());
  state_.v_odom += correction.segment<3>(6);
  state_.bias.gyroscope += correction.segment<3>(9);
  state_.bias.accelerometer += correction.segment<3>(12);
  T_map_odom_ = retract(T_map_odom_, correction.tail<6>());
}

}  // namespace fleetloc
