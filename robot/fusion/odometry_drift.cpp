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

// Covariance at the body, in odom axes. A corrected tilt also corrects what it had done to yaw and
// position within the odometry's window; a new one rotates about the body.
Matrix6d OdometryDrift::reported_drift(const OdometryEstimate& estimate) {
  const Pose& T_odom_body = estimate.state.T_odom_body;
  const Matrix6d to_odom = adjoint({T_odom_body.R, Eigen::Vector3d::Zero()});
  const Matrix6d covariance =
      to_odom * estimate.covariance.topLeftCorner<6, 6>() * to_odom.transpose();
  const Eigen::Matrix2d tilt = covariance.topLeftCorner<2, 2>();
  const Eigen::Matrix<double, 4, 2> shared = covariance.bottomLeftCorner<4, 2>();
  const Eigen::Matrix<double, 4, 2> by_tilt = tilt.ldlt().solve(shared.transpose()).transpose();
  const Eigen::Matrix4d yaw_and_position =
      covariance.bottomRightCorner<4, 4>() - by_tilt * shared.transpose();

  Matrix6d result = Matrix6d::Zero();
  for (int i = 0; i < 2; ++i) {
    const auto [up, down] = tilt_changes_[static_cast<std::size_t>(i)].update(tilt(i, i));
    Vector6d with_tilt = Vector6d::Unit(i);
    with_tilt.tail<4>() = by_tilt.col(i);
    result(i, i) += up;
    result += down * with_tilt * with_tilt.transpose();
  }
  if (last_) {
    Eigen::Matrix4d J = Eigen::Matrix4d::Identity();  // an old yaw error turns the way since
    J.block<3, 1>(1, 0) = Eigen::Vector3d::UnitZ().cross(T_odom_body.p - last_->T_odom_body.p);
    const Eigen::Matrix4d gained = yaw_and_position - J * last_->yaw_and_position * J.transpose();
    result.diagonal().tail<4>() += gained.diagonal().cwiseAbs();
  }
  last_ = {estimate.stamp, T_odom_body, yaw_and_position};
  return result;
}

DriftStep OdometryDrift::step(const OdometryEstimate& estimate) {
  const std::optional<Reported> last = last_;
  Matrix6d Q = config_.covariance_share * reported_drift(estimate);
  DriftStep result;
  if (!last) return result;
  if (estimate.is_standing) result.standstill = estimate.stamp - last->stamp;
  const Pose& T_odom_body = estimate.state.T_odom_body;
  result.metres = (T_odom_body.p - last->T_odom_body.p).norm();
  const double radians = log_so3(last->T_odom_body.R.conjugate() * T_odom_body.R).norm();
  const auto square = [](double x) { return x * x; };
  Vector6d walk;
  walk << Eigen::Vector2d::Constant(square(config_.tilt) * result.metres),
      square(config_.yaw) * result.metres + square(config_.yaw_by_rotation) * radians,
      Eigen::Vector3d::Constant(square(config_.translation) * result.metres);
  Q.diagonal() += walk;
  // Q is at the body: moved to the origin of odom.
  const Matrix6d A = adjoint({Eigen::Quaterniond::Identity(), T_odom_body.p});
  result.covariance = A * Q * A.transpose();
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
