#include "robot/fusion/odometry_drift.hpp"

#include <algorithm>

#include <Eigen/Cholesky>

#include "shared/geometry/angle.hpp"
#include "shared/geometry/so3.hpp"

namespace fleetloc {

VarianceChange::Step VarianceChange::update(double variance) {
  const double level = level_.value_or(variance);
  const bool turns =
      rises_ ? variance < (1.0 - kHysteresis) * level : variance * (1.0 - kHysteresis) > level;
  if (turns) rises_ = !rises_;
  if (level_ && rises_ != (variance > level)) return {};
  level_ = variance;
  return {.up = std::max(0.0, variance - level), .down = std::max(0.0, level - variance)};
}

OdometryDrift::OdometryDrift(const Config& config) : config_(config) {}

// Covariance at the body, in odom axes. A new rotation error rotates about the body. A corrected
// one also corrects the position error that it had caused.
Matrix6d OdometryDrift::reported_drift(const OdometryEstimate& estimate) {
  const Matrix6d to_odom = adjoint({estimate.state.T_odom_body.R, Eigen::Vector3d::Zero()});
  const Matrix6d covariance =
      to_odom * estimate.covariance.topLeftCorner<6, 6>() * to_odom.transpose();
  const Eigen::Matrix3d rotation = covariance.topLeftCorner<3, 3>();
  const Eigen::Matrix3d shared = covariance.bottomLeftCorner<3, 3>();
  const Eigen::Matrix3d by_rotation = rotation.ldlt().solve(shared.transpose()).transpose();
  const Eigen::Matrix3d position =
      covariance.bottomRightCorner<3, 3>() - by_rotation * shared.transpose();
  Vector6d variances;
  variances << rotation.diagonal(), position.diagonal();

  Matrix6d with_rotation = Matrix6d::Identity();
  with_rotation.bottomLeftCorner<3, 3>() = by_rotation;
  Matrix6d result = Matrix6d::Zero();
  for (int i = 0; i < 6; ++i) {
    const auto [up, down] = variance_changes_[static_cast<std::size_t>(i)].update(variances(i));
    result(i, i) += up;
    result += down * with_rotation.col(i) * with_rotation.col(i).transpose();
  }
  return result;
}

DriftStep OdometryDrift::step(const OdometryEstimate& estimate) {
  const Pose& T_odom_body = estimate.state.T_odom_body;
  Matrix6d Q = config_.covariance_share * reported_drift(estimate);
  DriftStep result;
  if (last_T_odom_body_) {
    result.metres = (T_odom_body.p - last_T_odom_body_->p).norm();
    const double radians = log_so3(last_T_odom_body_->R.conjugate() * T_odom_body.R).norm();
    const auto square = [](double x) { return x * x; };
    Vector6d walk;
    walk << Eigen::Vector2d::Constant(square(config_.tilt) * result.metres),
        square(config_.yaw) * result.metres + square(config_.yaw_by_rotation) * radians,
        Eigen::Vector3d::Constant(square(config_.translation) * result.metres);
    Q.diagonal() += walk;
    // Q is at the body: moved to the origin of odom.
    const Matrix6d A = adjoint({Eigen::Quaterniond::Identity(), T_odom_body.p});
    result.covariance = A * Q * A.transpose();
  }
  last_T_odom_body_ = T_odom_body;
  return result;
}

OdometryDrift::Config read_odometry_drift_config(ConfigReader section) {
  OdometryDrift::Config config;
  config.translation = section.positive("translation_m_per_sqrt_m");
  config.yaw = kRadPerDeg * section.positive("yaw_deg_per_sqrt_m");
  config.yaw_by_rotation = kRadPerDeg * section.positive("yaw_deg_per_sqrt_rad");
  config.tilt = kRadPerDeg * section.positive("tilt_deg_per_sqrt_m");
  config.covariance_share = section.positive("covariance_share");
  return config;
}

}  // namespace fleetloc
