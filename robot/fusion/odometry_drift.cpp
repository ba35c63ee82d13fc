#include "robot/fusion/odometry_drift.hpp"

#include <numbers>

#include "shared/geometry/so3.hpp"

namespace fleetloc {

OdometryDrift::OdometryDrift(const Config& config) : config_(config) {}

Eigen::Vector4d OdometryDrift::growth(const OdometryEstimate& estimate) {
  const Eigen::Matrix3d R = estimate.state.T_odom_body.R.toRotationMatrix();
  const Eigen::Matrix3d rotation = R * estimate.covariance.topLeftCorner<3, 3>() * R.transpose();
  const Eigen::Matrix3d position = R * estimate.covariance.block<3, 3>(3, 3) * R.transpose();
  Eigen::Vector4d variance;
  variance << position.diagonal(), rotation(2, 2);
  const bool first = !last_T_odom_body_;
  const Eigen::Vector4d largest = first ? variance : variance.cwiseMax(largest_variance_).eval();
  Eigen::Vector4d grown = first ? Eigen::Vector4d::Zero().eval() : largest - largest_variance_;
  largest_variance_ = largest;
  return grown;
}

DriftStep OdometryDrift::step(const OdometryEstimate& estimate) {
  const Pose& T_odom_body = estimate.state.T_odom_body;
  const Eigen::Vector4d claimed = config_.covariance_share * growth(estimate);
  DriftStep result;
  if (last_T_odom_body_) {
    result.metres = (T_odom_body.p - last_T_odom_body_->p).norm();
    const double radians = log_so3(last_T_odom_body_->R.conjugate() * T_odom_body.R).norm();
    const auto square = [](double x) { return x * x; };
    Matrix6d Q = Matrix6d::Zero();
    Q.diagonal().head<2>().setConstant(square(config_.tilt) * result.metres);
    Q(2, 2) = square(config_.yaw) * result.metres + square(config_.yaw_by_rotation) * radians +
              claimed(3);
    Q.diagonal().tail<3>() =
        claimed.head<3>() + Eigen::Vector3d::Constant(square(config_.translation) * result.metres);
    // So far at the body, in odom axes. T_map_odom turns about the body, not about the origin.
    const Matrix6d A = adjoint({Eigen::Quaterniond::Identity(), T_odom_body.p});
    result.covariance = A * Q * A.transpose();
  }
  last_T_odom_body_ = T_odom_body;
  return result;
}

OdometryDrift::Config read_odometry_drift_config(ConfigReader section) {
  constexpr double kRadians = std::numbers::pi / 180.0;
  OdometryDrift::Config config;
  config.translation = section.positive("translation_m_per_sqrt_m");
  config.yaw = kRadians * section.positive("yaw_deg_per_sqrt_m");
  config.yaw_by_rotation = kRadians * section.positive("yaw_deg_per_sqrt_rad");
  config.tilt = kRadians * section.positive("tilt_deg_per_sqrt_m");
  config.covariance_share = section.positive("covariance_share");
  return config;
}

}  // namespace fleetloc
