#include "robot/fusion/imu_prediction.hpp"

#include <array>
#include <cassert>
#include <cstddef>

#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

// The IMU's noise over one step in NavState's tangent at its end.
Matrix15d noise_of(const Preintegration& step, const NavState& from, const NavState& to) {
  // Position and velocity of the deltas are in the body frame at the start.
  Matrix9d J = Matrix9d::Identity();
  J.block<3, 3>(3, 3) = (to.T_odom_body.R.conjugate() * from.T_odom_body.R).toRotationMatrix();
  J.block<3, 3>(6, 6) = from.T_odom_body.R.toRotationMatrix();
  const ImuNoise& density = step.noise();
  const double dt = to_seconds(step.duration());
  Matrix15d Q = Matrix15d::Zero();
  Q.topLeftCorner<9, 9>() = J * step.covariance() * J.transpose();
  Q.diagonal().segment<3>(9).setConstant(density.gyroscope_random_walk *
                                         density.gyroscope_random_walk * dt);
  Q.diagonal().segment<3>(12).setConstant(density.accelerometer_random_walk *
                                          density.accelerometer_random_walk * dt);
  return Q;
}

// Constant pose; its variance is that of an unknown constant velocity, sigma^2 t^2.
void hold(ImuPrediction& prediction, const ImuSample& to, const ImuGapModel& gaps) {
  const double before = to_seconds(prediction.stamp - *prediction.gap_start);
  const double after = to_seconds(to.stamp - *prediction.gap_start);
  const double grown = after * after - before * before;
  auto variance = prediction.noise.diagonal();
  variance.head<3>().array() += gaps.turn_rate_sigma * gaps.turn_rate_sigma * grown;
  variance.segment<3>(3).array() += gaps.speed_sigma * gaps.speed_sigma * grown;
  prediction.state.v_odom.setZero();
  prediction.stamp = to.stamp;
  prediction.angular_velocity = to.angular_velocity - prediction.state.bias.gyroscope;
}

}  // namespace

Matrix15d transition_of(const Preintegration& step, const NavState& from, const NavState& to) {
  const auto deltas = step.deltas(from.bias);
  const Matrix96d& J_bias = step.bias_jacobian();
  const double dt = to_seconds(step.duration());
  const Eigen::Matrix3d R_odom_from = from.T_odom_body.R.toRotationMatrix();
  const Eigen::Matrix3d R_to_odom = to.T_odom_body.R.conjugate().toRotationMatrix();
  const Eigen::Matrix3d R_to_from = R_to_odom * R_odom_from;
  Matrix15d F = Matrix15d::Identity();
  F.block<3, 3>(0, 0) = deltas.R.conjugate().toRotationMatrix();
  F.block<3, 6>(0, 9) = J_bias.topRows<3>();
  F.block<3, 3>(3, 0) = -R_to_from * hat(deltas.p);
  F.block<3, 3>(3, 3) = R_to_from;
  F.block<3, 3>(3, 6) = R_to_odom * dt;
  F.block<3, 6>(3, 9) = R_to_from * J_bias.middleRows<3>(3);
  F.block<3, 3>(6, 0) = -R_odom_from * hat(deltas.v);
  F.block<3, 6>(6, 9) = R_odom_from * J_bias.bottomRows<3>();
  return F;
}

void advance(ImuPrediction& prediction, const Preintegration& step) {
  const NavState next = step.predict(prediction.state);
  const Matrix15d F = transition_of(step, prediction.state, next);
  prediction.transition = F * prediction.transition;
  prediction.noise = F * prediction.noise * F.transpose() + noise_of(step, prediction.state, next);
  prediction.state = next;
}

void advance(ImuPrediction& prediction,
             const ImuSample& from,
             const ImuSample& to,
             const ImuNoise& noise) {
  const ImuGapModel& gaps = noise.gaps;
  const double interval = to_seconds(to.stamp - from.stamp);
  if (!prediction.gap_start && gaps.void_from_s > 0.0 && interval > gaps.void_from_s) {
    prediction.gap_start = from.stamp;
  }
  if (prediction.gap_start) {
    return hold(prediction, to, gaps);
  }
  const std::array<ImuSample, 2> ends{from, to};
  advance(prediction, Preintegration(ends, prediction.state.bias, noise));
  prediction.stamp = to.stamp;
  prediction.angular_velocity = to.angular_velocity - prediction.state.bias.gyroscope;
}

ImuPrediction predict(const OdometryEstimate& start,
                      std::span<const ImuSample> samples,
                      const ImuNoise& noise) {
  assert(!samples.empty() && samples.front().stamp == start.stamp);
  ImuPrediction prediction;
  prediction.stamp = start.stamp;
  prediction.state = start.state;
  prediction.start_covariance = start.covariance;
  prediction.angular_velocity = samples.front().angular_velocity - start.state.bias.gyroscope;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    advance(prediction, samples[i - 1], samples[i], noise);
  }
  return prediction;
}

Matrix6d pose_covariance(const ImuPrediction& prediction) {
  const Eigen::Matrix<double, 6, 15> J = prediction.transition.topRows<6>();
  return J * prediction.start_covariance * J.transpose() + prediction.noise.topLeftCorner<6, 6>();
}

Matrix6d pose_covariance_since_start(const ImuPrediction& prediction) {
  const Eigen::Matrix<double, 6, 9> J = prediction.transition.block<6, 9>(0, 6);
  return J * prediction.start_covariance.bottomRightCorner<9, 9>() * J.transpose() +
         prediction.noise.topLeftCorner<6, 6>();
}

}  // namespace fleetloc
