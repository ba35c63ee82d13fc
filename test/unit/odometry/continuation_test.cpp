#include "robot/odometry/continuation.hpp"

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

/// A frame's dead-reckoned pose, with the second in its place.
PoseEstimate carried_at(int second) {
  PoseEstimate pose = dead_reckoned();
  pose.stamp = Timestamp{std::chrono::seconds(second)};
  pose.quality = Quality::kDeadReckoning;
  pose.T_odom_body.p.x() = second;
  return pose;
}

Initialization start_at(int second) {
  Initialization start = new_start();
  start.keyframes.resize(2);
  start.keyframes[0].frame.stamp = Timestamp{std::chrono::seconds(second)};
  start.keyframes[1].frame.stamp = Timestamp{std::chrono::seconds(second + 1)};
  return start;
}

TEST(Continuation, GoesOnFromThePoseOfTheNewOldestKeyframe) {
  Continuation continuation;
  for (int second = 100; second < 103; ++second) continuation.add(carried_at(second));
  Initialization start = start_at(101);
  const auto continued = continuation.apply(start);
  ASSERT_TRUE(continued.has_value());
  EXPECT_EQ(continued->stamp, start.keyframes[0].frame.stamp);
  EXPECT_NEAR(start.states[0].T_odom_body.p.x(), 101.0, 1e-9);
  Initialization again = start_at(101);
  EXPECT_FALSE(continuation.apply(again).has_value());  // all is forgotten
}

TEST(Continuation, LeavesAStartAloneThatItKnowsNoPoseOf) {
  Continuation continuation;
  continuation.add(carried_at(100));
  PoseEstimate nothing = carried_at(101);
  nothing.quality = Quality::kInitializing;  // there was no pose
  continuation.add(nothing);
  for (const int second : {101, 102}) {
    Initialization start = start_at(second);
    EXPECT_FALSE(continuation.apply(start).has_value());
    EXPECT_EQ(start.states[0].T_odom_body.p, new_start().states[0].T_odom_body.p);
  }
}

TEST(Continuation, KeepsHalfAMinuteOnly) {
  Continuation continuation;
  for (int second = 0; second <= 100; ++second) continuation.add(carried_at(second));
  Initialization start = start_at(69);
  EXPECT_FALSE(Continuation(continuation).apply(start).has_value());
  start = start_at(71);
  EXPECT_TRUE(continuation.apply(start).has_value());
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

// By a turn about z of the map and a shift of the body, of this T_map_odom.
Vector6d yaw_and_shift(const MapOdomEstimate& estimate,
                       double yaw_rad,
                       const Eigen::Vector3d& shift_map,
                       const Pose& T_odom_body) {
  const Pose T_map_body = estimate.T_map_odom * T_odom_body;
  const Pose moved{exp_so3({0.0, 0.0, yaw_rad}) * T_map_body.R, T_map_body.p + shift_map};
  return local_coordinates(estimate.T_map_odom, moved * inverse(T_odom_body));
}

TEST(Continuation, CarriesYawAndPositionInTheMapWithTheirCovariance) {
  PoseEstimate before = dead_reckoned();
  before.covariance_map.topLeftCorner<2, 2>() *= 1e4;  // the tilt was lost
  const Pose T_odom_body{exp_so3({0.05, 0.02, 1.4}), {30.0, -20.0, 1.0}};
  const MapOdomEstimate carried = continued_alignment(before, T_odom_body);
  EXPECT_LT((carried.T_map_odom.R * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitZ()).norm(),
            1e-12);
  const Pose T_map_body = carried.T_map_odom * T_odom_body;
  EXPECT_LT((T_map_body.p - before.T_map_body->p).norm(), 1e-9);
  EXPECT_NEAR(log_so3(before.T_map_body->R * T_map_body.R.conjugate()).z(), 0.0, 0.02);

  const auto J = [](const Pose& pose) {
    Eigen::Matrix<double, 4, 6> result = Eigen::Matrix<double, 4, 6>::Zero();
    result.topLeftCorner<1, 3>() = pose.R.toRotationMatrix().row(2);
    result.bottomRightCorner<3, 3>() = pose.R.toRotationMatrix();
    return result;
  }(*before.T_map_body);
  Eigen::Matrix<double, 6, 4> moves;  // numerically, per yaw and shift
  constexpr double kStep = 1e-6;
  moves.col(0) = yaw_and_shift(carried, kStep, {0, 0, 0}, T_odom_body) / kStep;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d shift = kStep * Eigen::Vector3d::Unit(i);
    moves.col(1 + i) = yaw_and_shift(carried, 0.0, shift, T_odom_body) / kStep;
  }
  const Matrix6d expected = moves * J * before.covariance_map * J.transpose() * moves.transpose();
  EXPECT_TRUE(carried.covariance.isApprox(expected, 1e-4)) << carried.covariance - expected;
}

TEST(Continuation, GrowsAStartPoseThatNoAnswerHasConfirmedByTheDriftOfYawAndPosition) {
  const MapOdomEstimate start{{exp_so3({0.0, 0.0, 0.3}), {1.0, 2.0, 3.0}},
                              0.01 * Matrix6d::Identity()};
  PoseEstimate drifted = dead_reckoned();
  const Eigen::Matrix3d R = drifted.T_odom_body.R.toRotationMatrix();
  Matrix6d axes = Matrix6d::Zero();  // of the body's perturbation along the axes of odom
  axes.topLeftCorner<3, 3>() = R;
  axes.bottomRightCorner<3, 3>() = R;
  Vector6d variances;
  variances << 0.3, 0.2, 4e-4, 0.04, 0.09, 0.01;
  drifted.covariance_odom = axes.transpose() * variances.asDiagonal() * axes;
  const MapOdomEstimate grown = continued_start(start, drifted);
  EXPECT_LT(local_coordinates(grown.T_map_odom, start.T_map_odom).norm(), 1e-12);
  const Matrix6d A = axes * adjoint(inverse(drifted.T_odom_body));
  variances.head<2>().setZero();
  const Matrix6d added = A * (grown.covariance - start.covariance) * A.transpose();
  EXPECT_TRUE(added.isApprox(Matrix6d(variances.asDiagonal()), 1e-9)) << added;
}

}  // namespace
}  // namespace fleetloc
