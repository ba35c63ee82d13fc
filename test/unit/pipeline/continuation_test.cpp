#include "robot/pipeline/continuation.hpp"

#include <gtest/gtest.h>

#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

PoseEstimate dead_reckoned() {
  PoseEstimate pose;
  pose.T_odom_body = {exp_so3({0.1, -0.2, 1.5}), {3.0, -2.0, 1.0}};
  pose.covariance_odom.diagonal() << 1e-4, 2e-4, 4e-4, 0.04, 0.09, 0.01;
  pose.T_map_body = Pose{exp_so3({0.1, -0.2, 2.0}), {10.0, 4.0, 1.0}};
  pose.covariance_map = 2.0 * pose.covariance_odom;
  return pose;
}

// Two keyframes of a new odometry that lies elsewhere, turned about z only.
Initialization new_start() {
  const Pose T_new_odom{exp_so3({0.0, 0.0, -0.7}), {-1.0, 5.0, 2.0}};
  Initialization start;
  start.states.resize(2);
  start.states[0].T_odom_body = T_new_odom * dead_reckoned().T_odom_body;
  start.states[0].v_odom = {1.0, 0.0, 0.2};
  start.states[1] = start.states[0];
  start.states[1].T_odom_body.p += Eigen::Vector3d(0.5, 0.0, 0.1);
  return start;
}

TEST(Continuation, PutsTheOldestKeyframeWhereTheRobotWasAndKeepsTheMotion) {
  Initialization start = new_start();
  const Initialization before = start;
  continue_from(dead_reckoned(), start);
  const Pose& oldest = start.states[0].T_odom_body;
  EXPECT_LT(local_coordinates(oldest, dead_reckoned().T_odom_body).norm(), 1e-9);
  const Pose moved = inverse(oldest) * start.states[1].T_odom_body;
  const Pose moved_before = inverse(before.states[0].T_odom_body) * before.states[1].T_odom_body;
  EXPECT_LT(local_coordinates(moved, moved_before).norm(), 1e-9);
  const Eigen::Vector3d v_body = oldest.R.conjugate() * start.states[0].v_odom;
  const Eigen::Vector3d v_body_before =
      before.states[0].T_odom_body.R.conjugate() * before.states[0].v_odom;
  EXPECT_LT((v_body - v_body_before).norm(), 1e-9);
}

TEST(Continuation, KeepsTheTiltThatTheNewOdometryHasFound) {
  Initialization start = new_start();
  for (NavState& state : start.states) {
    state.T_odom_body.R = exp_so3({0.05, -0.03, 0.0}) * state.T_odom_body.R;
  }
  const Eigen::Vector3d up_body =
      start.states[0].T_odom_body.R.conjugate() * Eigen::Vector3d::UnitZ();
  continue_from(dead_reckoned(), start);
  const Eigen::Vector3d up_body_after =
      start.states[0].T_odom_body.R.conjugate() * Eigen::Vector3d::UnitZ();
  EXPECT_LT((up_body - up_body_after).norm(), 1e-9);
  const Eigen::Vector3d rotation =
      log_so3(start.states[0].T_odom_body.R * dead_reckoned().T_odom_body.R.conjugate());
  EXPECT_NEAR(rotation.z(), 0.0, 2e-3);
}

TEST(Continuation, TakesTheUncertaintyOver) {
  Initialization start = new_start();
  continue_from(dead_reckoned(), start);
  // The position's covariance is in body axes before and in odom axes after.
  EXPECT_NEAR((start.drift.bottomRightCorner<3, 3>().trace()), 0.04 + 0.09 + 0.01, 1e-9);
  EXPECT_GT(start.drift(0, 0), 1e-4);
  EXPECT_LT(start.drift(0, 0), 4.1e-4);
}

TEST(Continuation, CarriesTheMapPoseWithItsCovariance) {
  const PoseEstimate before = dead_reckoned();
  const Pose T_odom_body{exp_so3({0.1, -0.2, 1.5}), {3.1, -2.0, 1.0}};
  const MapOdomEstimate carried = continued_alignment(before, T_odom_body);
  EXPECT_LT(local_coordinates(carried.T_map_odom * T_odom_body, *before.T_map_body).norm(), 1e-9);
  const Matrix6d A = adjoint(inverse(T_odom_body));
  EXPECT_TRUE((A * carried.covariance * A.transpose()).isApprox(before.covariance_map, 1e-9));
}

TEST(Continuation, GrowsAStartPoseThatNoAnswerHasConfirmed) {
  const MapOdomEstimate start{{exp_so3({0.0, 0.0, 0.3}), {1.0, 2.0, 3.0}},
                              0.01 * Matrix6d::Identity()};
  const MapOdomEstimate grown = continued_start(start, dead_reckoned());
  EXPECT_LT(local_coordinates(grown.T_map_odom, start.T_map_odom).norm(), 1e-12);
  const Matrix6d added = grown.covariance - start.covariance;
  const Matrix6d A = adjoint(inverse(dead_reckoned().T_odom_body));
  EXPECT_TRUE((A * added * A.transpose()).isApprox(dead_reckoned().covariance_odom, 1e-9));
}

}  // namespace
}  // namespace fleetloc
