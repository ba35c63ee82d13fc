#include "robot/odometry/odometry_health.hpp"

#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

// In body axes, where the drift of odom's yaw has no part.
Eigen::Matrix3d velocity_covariance(const OdometryEstimate& estimate) {
  const Eigen::Matrix3d R_body_odom = estimate.state.T_odom_body.R.conjugate().toRotationMatrix();
  Eigen::Matrix<double, 3, 9> J;
  J << hat(R_body_odom * estimate.state.v_odom), Eigen::Matrix3d::Zero(), R_body_odom;
  return J * estimate.covariance.topLeftCorner<9, 9>() * J.transpose();
}

}  // namespace

std::string_view name(ResetCause cause) {
  switch (cause) {
    case ResetCause::kImuGap:
      return "imu_gap";
    case ResetCause::kDiverged:
      return "diverged";
    case ResetCause::kImplausibleBias:
      return "implausible_bias";
    case ResetCause::kVisionLost:
      return "vision_lost";
    case ResetCause::kUncertain:
      return "uncertain";
  }
  return "unknown";
}

// All comparisons are such that NaN fails.
expected<void, ResetCause> OdometryHealth::check(const WindowEstimate& window) {
  const WindowKeyframe& newest = window.keyframes.back();
  const ImuBias& bias = newest.state.bias;
  if (!window.diagnostics.converged || !(newest.state.v_odom.norm() <= config_.max_speed)) {
    return unexpected(ResetCause::kDiverged);
  }
  if (!(bias.gyroscope.norm() <= config_.max_gyroscope_bias) ||
      !(bias.accelerometer.norm() <= config_.max_accelerometer_bias)) {
    return unexpected(ResetCause::kImplausibleBias);
  }
  if (!last_vision_update_) last_vision_update_ = newest.stamp;
  return {};
}

expected<void, ResetCause> OdometryHealth::check(const FrameEstimator::Result& frame) {
  const OdometryEstimate& estimate = frame.estimate;
  if (frame.vision_updated || !last_vision_update_) last_vision_update_ = estimate.stamp;
  if (to_seconds(estimate.stamp - *last_vision_update_) > config_.max_vision_lost_s)
    return unexpected(ResetCause::kVisionLost);
  if (!(estimate.state.v_odom.norm() <= config_.max_speed))
    return unexpected(ResetCause::kDiverged);
  const Eigen::Array3d sigma = velocity_covariance(estimate).diagonal().array().sqrt();
  if (!(sigma <= config_.max_velocity_sigma).all()) return unexpected(ResetCause::kUncertain);
  return {};
}

OdometryHealth::Config read_odometry_health_config(ConfigReader section) {
  return {.max_vision_lost_s = section.positive("max_vision_lost_s"),
          .max_velocity_sigma = section.positive("max_velocity_sigma"),
          .max_speed = section.positive("max_speed"),
          .max_gyroscope_bias = section.positive("max_gyroscope_bias"),
          .max_accelerometer_bias = section.positive("max_accelerometer_bias")};
}

}  // namespace fleetloc
