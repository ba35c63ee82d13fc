#include "robot/node/ros2_poses.hpp"

#include <gtest/gtest.h>

#include "robot/node/ros2_output.hpp"

namespace fleetloc {
namespace {

using namespace std::chrono_literals;

constexpr double kTolerance = 1e-9;

/// A camera head above and before the base, turned and tilted.
RosFrames frames() {
  RosFrames frames;
  frames.T_base_imu = exp_se3((Vector6d() << 0.3, -0.2, 1.5, 0.4, -0.1, 0.7).finished());
  return frames;
}

PoseEstimate pose() {
  PoseEstimate pose;
  pose.stamp = Timestamp(5s);
  pose.quality = Quality::kLocalized;
  pose.T_odom_body = exp_se3((Vector6d() << 0.1, 0.5, -0.9, 3.0, -2.0, 0.5).finished());
  pose.T_map_body = exp_se3((Vector6d() << -0.2, 0.1, 2.0, 30.0, 20.0, 1.0).finished());
  pose.covariance_odom = Vector6d(1e-4, 2e-4, 3e-4, 4e-3, 5e-3, 6e-3).asDiagonal();
  pose.covariance_map = 2.0 * pose.covariance_odom;
  pose.v_odom = {0.5, -0.3, 0.1};
  pose.angular_velocity = {0.2, -0.4, 0.9};
  return pose;
}

void expect_same(const Pose& a, const Pose& b) {
  EXPECT_LT(local_coordinates(a, b).norm(), kTolerance);
}

TEST(Ros2Poses, AreOfTheBaseFrame) {
  const OdometryMessage odometry = odometry_message(pose(), frames());
  expect_same(odometry.pose.T_a_b * frames().T_base_imu, pose().T_odom_body);
  EXPECT_EQ(odometry.pose.header.frame, "odom");
  EXPECT_EQ(odometry.child_frame, "base_link");
  const PoseMessage in_map = map_pose_message(pose(), frames());
  expect_same(in_map.T_a_b * frames().T_base_imu, *pose().T_map_body);
  EXPECT_EQ(in_map.header.frame, "map");
}

TEST(Ros2Poses, ThatAreGivenAreThoseThatArePublished) {
  const auto given = given_pose(map_pose_message(pose(), frames()), frames());
  ASSERT_TRUE(given);
  EXPECT_EQ(given->stamp, pose().stamp);
  expect_same(given->T_map_body, *pose().T_map_body);
  EXPECT_LT((given->covariance - pose().covariance_map).norm(), kTolerance);
}

TEST(Ros2Poses, AreNotGivenInAnotherFrame) {
  PoseMessage message = map_pose_message(pose(), frames());
  message.header.frame = "odom";
  EXPECT_FALSE(given_pose(message, frames()));
}

TEST(Ros2Poses, AreTiedTogetherByTheirTransforms) {
  const TransformMessage odom_base = odom_base_transform(pose(), frames());
  const TransformMessage map_odom = map_odom_transform(pose(), frames());
  EXPECT_EQ(map_odom.child_frame, odom_base.header.frame);
  expect_same(map_odom.T_a_b * odom_base.T_a_b, map_pose_message(pose(), frames()).T_a_b);
}

TEST(Ros2Poses, HaveTheVelocityOfTheBaseByFiniteDifferences) {
  constexpr double kStep_s = 1e-5;
  const OdometryMessage odometry = odometry_message(pose(), frames());
  PoseEstimate moved = pose();
  moved.T_odom_body.p += kStep_s * moved.v_odom;
  Vector6d turn = Vector6d::Zero();
  turn.head<3>() = kStep_s * moved.angular_velocity;
  moved.T_odom_body = retract(moved.T_odom_body, turn);
  const Pose T_odom_base = odometry.pose.T_a_b;
  const Pose T_odom_moved = odometry_message(moved, frames()).pose.T_a_b;
  const Eigen::Vector3d v_odom = (T_odom_moved.p - T_odom_base.p) / kStep_s;
  EXPECT_LT((T_odom_base.R.conjugate() * v_odom - odometry.v_b).norm(), 1e-4);
  const Vector6d motion = local_coordinates(T_odom_base, T_odom_moved) / kStep_s;
  EXPECT_LT((motion.head<3>() - odometry.angular_velocity).norm(), 1e-4);
}

TEST(Ros2Poses, MoveTheCovarianceAsTheyMovePerturbations) {
  const double step = 1e-6;
  Matrix6d J;
  const PoseMessage at = map_pose_message(pose(), frames());
  for (int i = 0; i < 6; ++i) {
    PoseEstimate moved = pose();
    moved.T_map_body = retract(*moved.T_map_body, step * Vector6d::Unit(i));
    J.col(i) = local_coordinates(at.T_a_b, map_pose_message(moved, frames()).T_a_b) / step;
  }
  const Matrix6d expected = J * pose().covariance_map * J.transpose();
  EXPECT_LT((at.covariance - expected).norm(), 1e-5 * expected.norm());
}

int due_within_a_second(double rate_hz, Duration interval) {
  Rate rate(rate_hz);
  int due = 0;
  for (Duration t{}; t < Duration(1s); t += interval) due += rate.is_due(Timestamp(t)) ? 1 : 0;
  return due;
}

TEST(RateOfOutputs, IsKeptAtAnyRateOfSamples) {
  EXPECT_EQ(due_within_a_second(50.0, 5ms), 50);
  EXPECT_EQ(due_within_a_second(30.0, 5ms), 30);
  EXPECT_EQ(due_within_a_second(1000.0, 5ms), 200);  // not more than there are
  EXPECT_EQ(due_within_a_second(0.0, 5ms), 0);
}

TEST(RateOfOutputs, GoesOnWhenTheClockIsSet) {
  Rate rate(10.0);
  EXPECT_TRUE(rate.is_due(Timestamp(100s)));
  EXPECT_FALSE(rate.is_due(Timestamp(100s + 50ms)));
  EXPECT_TRUE(rate.is_due(Timestamp(50s)));
  EXPECT_TRUE(rate.is_due(Timestamp(3600s)));
  EXPECT_FALSE(rate.is_due(Timestamp(3600s + 50ms)));
}

}  // namespace
}  // namespace fleetloc
