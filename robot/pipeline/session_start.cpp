#include "robot/pipeline/session_start.hpp"

#include <cmath>
#include <utility>

#include <Eigen/Eigenvalues>

#include "robot/odometry/continuation.hpp"
#include "shared/geometry/so3.hpp"

namespace fleetloc {

namespace {

// Right perturbations, of a pose with this attitude, along the axes of its parent.
Matrix6d turned(const Matrix6d& covariance, const Eigen::Quaterniond& R) {
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = R.toRotationMatrix();
  turn.bottomRightCorner<3, 3>() = R.toRotationMatrix();
  return turn * covariance * turn.transpose();
}

Matrix6d diagonal(double tilt_rad, double yaw_rad, double position_m) {
  Vector6d sigmas;
  sigmas << tilt_rad, tilt_rad, yaw_rad, position_m, position_m, position_m;
  return sigmas.cwiseAbs2().asDiagonal();
}

// What is said of yaw and position, and `sigma` where nothing is: rounding leaves little of zero.
Matrix6d covariance_map_of(const GivenPose& given, const StartUncertainty& sigma) {
  constexpr double kZero = 1e-9;  // [rad^2, m^2]
  const Matrix6d said = turned(given.covariance, given.T_map_body.R);
  Matrix6d result = covariance(sigma);
  for (int i = 2; i < 6; ++i) {
    for (int j = 2; j < 6; ++j) {
      if (said(i, i) > kZero && said(j, j) > kZero) result(i, j) = said(i, j);
    }
  }
  return result;
}

Pose levelled(const Pose& T_map_body, const Pose& T_odom_body) {
  return {yaw_between(T_odom_body.R, T_map_body.R) * T_odom_body.R, T_map_body.p};
}

}  // namespace

Matrix6d covariance(const StartUncertainty& sigma) {
  return diagonal(sigma.tilt_sigma_rad, sigma.yaw_sigma_rad, sigma.position_sigma_m);
}

MapOdomEstimate map_odom_estimate_at(const Pose& T_map_body,
                                     const Pose& T_odom_body,
                                     const Matrix6d& covariance_map) {
  const Matrix6d covariance = turned(covariance_map, T_map_body.R.conjugate());
  const Matrix6d A = adjoint(T_odom_body);
  return {.T_map_odom = T_map_body * inverse(T_odom_body),
          .covariance = A * covariance * A.transpose(),
          .p_odom = T_odom_body.p};
}

std::string_view name(NoStart reason) {
  return reason == NoStart::kUnknown ? "unknown_starts" : "withheld_starts";
}

SessionStart::SessionStart(std::optional<Pose> T_map_body,
                           const StartUncertainty& sigma,
                           const ImuGapModel& imu_gaps)
    : sigma_(sigma), imu_gaps_(imu_gaps) {
  if (T_map_body) first_pose_ = {.T_map_body = *T_map_body, .covariance_map = covariance(sigma)};
}

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
  } else if (first_pose_) {
    latest_ = from_first_pose(begin);
  } else {
    latest_.reset();
  }
  if (!latest_) return unexpected(NoStart::kUnknown);
  const bool as_given = begin.T_first_newest.has_value();
  if (!as_given && !is_certain_enough(*latest_, T_odom_body)) {
    return unexpected(NoStart::kTooUncertain);
  }
  return *latest_;
}

MapOdomEstimate SessionStart::place(const GivenPose& given, const Pose& T_odom_body) {
  first_pose_.reset();
  latest_ = map_odom_estimate_at(
      levelled(given.T_map_body, T_odom_body), T_odom_body, covariance_map_of(given, sigma_));
  return *latest_;
}

void SessionStart::place_before_odometry(const GivenPose& given) {
  first_pose_ = {.T_map_body = given.T_map_body,
                 .covariance_map = covariance_map_of(given, sigma_),
                 .is_placed = true};
}

// The pose refers to the first frame. Where the motion since then was not observed, its bounds
// (ImuGapModel) are added; where somebody has told the pose meanwhile, the motion itself.
MapOdomEstimate SessionStart::from_first_pose(const OdometryStart& begin) const {
  Pose T_map_body = first_pose_->T_map_body;
  Matrix6d covariance_map = first_pose_->covariance_map;
  if (const auto& T_first_newest = begin.T_first_newest) {
    T_map_body = T_map_body * *T_first_newest;
    if (first_pose_->is_placed) {
      const double angle = log_so3(T_first_newest->R).norm();
      covariance_map += diagonal(0.0, angle, T_first_newest->p.norm());
    }
  } else {
    const double t = to_seconds(begin.stamp - *first_frame_);
    const double angle = imu_gaps_.turn_rate_sigma * t;
    covariance_map += diagonal(angle, angle, imu_gaps_.speed_sigma * t);
  }
  if (first_pose_->is_placed) T_map_body = levelled(T_map_body, begin.T_odom_body);
  return map_odom_estimate_at(T_map_body, begin.T_odom_body, covariance_map);
}

bool SessionStart::is_certain_enough(const MapOdomEstimate& start, const Pose& T_odom_body) const {
  const Matrix6d A = adjoint(inverse(T_odom_body));
  const Matrix6d covariance = A * start.covariance * A.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance.bottomRightCorner<3, 3>(),
                                                              Eigen::EigenvaluesOnly);
  return std::sqrt(solver.eigenvalues().maxCoeff()) <= sigma_.max_carried_sigma_m;
}

}  // namespace fleetloc
