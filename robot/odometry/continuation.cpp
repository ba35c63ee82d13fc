#include "robot/odometry/continuation.hpp"

#include <chrono>
#include <cmath>
#include <numbers>
#include <utility>

#include "robot/vio/gauge_factor.hpp"
#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

// Initializations look back less far than this.
constexpr Duration kKeptFor = std::chrono::seconds(30);
// Of the heading [rad]: a pose that is less certain tells nothing. As drift of a window it would
// drown what the window knows in rounding errors (seen at 150 rad, after an hour's gap forever).
constexpr double kMaxHeadingSigma = 2.0 * std::numbers::pi;

bool is_lost(const PoseEstimate& pose) {
  const double variance = pose.covariance_odom.topLeftCorner<3, 3>().diagonal().maxCoeff();
  return !(variance <= kMaxHeadingSigma * kMaxHeadingSigma);
}

// Of a perturbation of one pose its yaw and translation, as a perturbation of another one.
Matrix6d without_tilt(const Pose& of, const Pose& as) {
  return yaw_and_position_jacobian(as).transpose() * yaw_and_position_jacobian(of);
}

}  // namespace

Eigen::Quaterniond yaw_between(const Eigen::Quaterniond& from, const Eigen::Quaterniond& to) {
  const Eigen::Matrix3d R = (to * from.conjugate()).toRotationMatrix();
  return exp_so3({0.0, 0.0, std::atan2(R(1, 0) - R(0, 1), R(0, 0) + R(1, 1))});
}

void Continuation::add(const PoseEstimate& dead_reckoned) {
  const Timestamp horizon = dead_reckoned.stamp - kKeptFor;
  dead_reckoned_.erase(dead_reckoned_.begin(), dead_reckoned_.lower_bound(horizon));
  dead_reckoned_.emplace(dead_reckoned.stamp, dead_reckoned);
}

std::optional<PoseEstimate> Continuation::apply(Initialization& initialization) {
  const auto kept = std::exchange(dead_reckoned_, {});
  const auto found = kept.find(initialization.keyframes.front().frame.stamp);
  if (found == kept.end() || found->second.quality == Quality::kInitializing) return std::nullopt;
  if (is_lost(found->second)) return std::nullopt;
  continue_from(found->second, initialization);
  return found->second;
}

void continue_from(const PoseEstimate& dead_reckoned, Initialization& initialization) {
  const Pose& T_odom_body = dead_reckoned.T_odom_body;
  const Pose T_new_body = initialization.states.front().T_odom_body;
  Pose T_odom_new;
  T_odom_new.R = yaw_between(T_new_body.R, T_odom_body.R);
  T_odom_new.p = T_odom_body.p - T_odom_new.R * T_new_body.p;
  for (NavState& state : initialization.states) {
    state.T_odom_body = T_odom_new * state.T_odom_body;
    state.v_odom = T_odom_new.R * state.v_odom;
  }
  const auto A = yaw_and_position_jacobian(T_odom_body);
  initialization.drift = A * dead_reckoned.covariance_odom * A.transpose();
}

MapOdomEstimate continued_alignment(const PoseEstimate& dead_reckoned, const Pose& T_odom_body) {
  const Pose& T_map_body = *dead_reckoned.T_map_body;
  Pose T_map_odom;
  T_map_odom.R = yaw_between(T_odom_body.R, T_map_body.R);
  T_map_odom.p = T_map_body.p - T_map_odom.R * T_odom_body.p;
  const Matrix6d A =
      adjoint(T_odom_body) * without_tilt(T_map_body, {T_map_odom.R * T_odom_body.R, T_map_body.p});
  return {.T_map_odom = T_map_odom,
          .covariance = A * dead_reckoned.covariance_map * A.transpose(),
          .p_odom = T_odom_body.p};
}

MapOdomEstimate continued_start(const MapOdomEstimate& start, const PoseEstimate& dead_reckoned) {
  const Pose& T_odom_body = dead_reckoned.T_odom_body;
  const Matrix6d A = adjoint(T_odom_body) * without_tilt(T_odom_body, T_odom_body);
  return {.T_map_odom = start.T_map_odom,
          .covariance = start.covariance + A * dead_reckoned.covariance_odom * A.transpose(),
          .p_odom = T_odom_body.p};
}

}  // namespace fleetloc
