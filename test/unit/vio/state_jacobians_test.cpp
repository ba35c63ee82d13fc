#include "robot/vio/state_jacobians.hpp"

#include <gtest/gtest.h>

#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

constexpr double kStep = 1e-6;

const Pose kOther{exp_so3({0.3, -0.7, 1.9}), {4.0, -2.0, 1.0}};
const NavState kState{.T_odom_body = {exp_so3({-0.4, 0.2, -2.1}), {9.0, 3.0, -1.5}},
                      .v_odom = {1.5, -0.8, 0.3},
                      .bias = {{0.01, 0.02, 0.03}, {-0.1, 0.2, 0.05}}};

/// `state` after a motion of odom: x becomes R x + p.
NavState moved(const NavState& state, const Pose& motion) {
  return {.T_odom_body = motion * state.T_odom_body,
          .v_odom = motion.R * state.v_odom,
          .bias = state.bias};
}

Vector15d difference(const NavState& from, const NavState& to) {
  Vector15d d;
  d << local_coordinates(from.T_odom_body, to.T_odom_body), to.v_odom - from.v_odom,
      to.bias.gyroscope - from.bias.gyroscope, to.bias.accelerometer - from.bias.accelerometer;
  return d;
}

/// Columns are central differences of the state by motions of odom.
template <int N, typename Motion>
Eigen::Matrix<double, 15, N> numeric(const Motion& motion) {
  Eigen::Matrix<double, 15, N> J;
  for (int i = 0; i < N; ++i) {
    const Eigen::Vector<double, N> d = kStep * Eigen::Vector<double, N>::Unit(i);
    J.col(i) = difference(moved(kState, motion(-d)), moved(kState, motion(d))) / (2.0 * kStep);
  }
  return J;
}

TEST(StateJacobians, ByYawAndPositionIsTheNumericOne) {
  const auto motion = [](const Eigen::Vector4d& d) {
    // About the other body: yaw, then the shift.
    const Eigen::Quaterniond R = exp_so3({0.0, 0.0, d(0)});
    return Pose{R, kOther.p - R * kOther.p + d.tail<3>()};
  };
  EXPECT_LT((jacobian_by_yaw_and_position(kOther, kState) - numeric<4>(motion)).norm(), 1e-8);
}

TEST(StateJacobians, ByPoseIsTheNumericOne) {
  const auto motion = [](const Vector6d& d) { return retract(kOther, d) * inverse(kOther); };
  EXPECT_LT((jacobian_by_pose(kOther, kState) - numeric<6>(motion)).norm(), 1e-8);
}

}  // namespace
}  // namespace fleetloc
