#include "robot/pipeline/session_start.hpp"

#include <cmath>
#include <utility>

#include <Eigen/Eigenvalues>

namespace fleetloc {

MapOdomEstimate map_odom_estimate_at(const Pose& T_map_body,
                                     const Pose& T_odom_body,
                                     const StartUncertainty& sigma) {
  const Eigen::Matrix3d R_body_map = T_map_body.R.toRotationMatrix().transpose();
  const Eigen::Vector3d rotation_sigma(
      sigma.tilt_sigma_rad, sigma.tilt_sigma_rad, sigma.yaw_sigma_rad);
  Matrix6d covariance_body = Matrix6d::Zero();
  covariance_body.topLeftCorner<3, 3>() =
      R_body_map * rotation_sigma.cwiseAbs2().asDiagonal() * R_body_map.transpose();
  covariance_body.bottomRightCorner<3, 3>() =
      Eigen::Matrix3d::Identity() * sigma.position_sigma_m * sigma.position_sigma_m;
  const Matrix6d A = adjoint(T_odom_body);
  return {.T_map_odom = T_map_body * inverse(T_odom_body),
          .covariance = A * covariance_body * A.transpose(),
          .p_odom = T_odom_body.p};
}

std::string_view name(NoStart reason) {
  return reason == NoStart::kUnknown ? "unknown_starts" : "withheld_starts";
}

SessionStart::SessionStart(std::optional<Pose> T_map_body,
                           const StartUncertainty& sigma,
                           const ImuGapModel& imu_gaps)
    : T_map_body_(std::move(T_map_body)), sigma_(sigma), imu_gaps_(imu_gaps) {}

void SessionStart::note_frame(Timestamp stamp) {
  if (!first_frame_) first_frame_ = stamp;
}

expected<MapOdomEstimate, NoStart> SessionStart::of_session(
    const OdometryStart& begin,
    const Pose& T_odom_body,
    const std::optional<MapOdomEstimate>& from_answers) {
  if (from_answers) {
    latest_ = from_answers;
  } else if (begin.continued && latest_) {
    latest_ = continued_start(*latest_, *begin.continued);
  } else if (T_map_body_) {
    latest_ = from_user(begin);
  } else {
    latest_.reset();
  }
  if (!latest_) return unexpected(NoStart::kUnknown);
  const bool as_given_by_user = begin.T_first_newest.has_value();
  if (!as_given_by_user && !is_certain_enough(*latest_, T_odom_body)) {
    return unexpected(NoStart::kTooUncertain);
  }
  return *latest_;
}

// The user's start pose refers to the first frame. Where the motion since then was not observed,
// its bounds (ImuGapModel) are added.
MapOdomEstimate SessionStart::from_user(const OdometryStart& begin) const {
  if (begin.T_first_newest) {
    return map_odom_estimate_at(*T_map_body_ * *begin.T_first_newest, begin.T_odom_body, sigma_);
  }
  const double t = to_seconds(begin.stamp - *first_frame_);
  StartUncertainty sigma = sigma_;
  sigma.position_sigma_m = std::hypot(sigma.position_sigma_m, imu_gaps_.speed_sigma * t);
  sigma.yaw_sigma_rad = std::hypot(sigma.yaw_sigma_rad, imu_gaps_.turn_rate_sigma * t);
  sigma.tilt_sigma_rad = std::hypot(sigma.tilt_sigma_rad, imu_gaps_.turn_rate_sigma * t);
  return map_odom_estimate_at(*T_map_body_, begin.T_odom_body, sigma);
}

bool SessionStart::is_certain_enough(const MapOdomEstimate& start, const Pose& T_odom_body) const {
  const Matrix6d A = adjoint(inverse(T_odom_body));
  const Matrix6d covariance = A * start.covariance * A.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance.bottomRightCorner<3, 3>(),
                                                              Eigen::EigenvaluesOnly);
  return std::sqrt(solver.eigenvalues().maxCoeff()) <= sigma_.max_carried_sigma_m;
}

}  // namespace fleetloc
