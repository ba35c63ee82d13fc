#include <functional>
#include <limits>

#include <idl/ros2/geometry_msgs.h>

#include "test/unit/ros2/samples.hpp"

namespace fleetloc {
namespace {

using geometry_msgs::msg::dds_::PoseWithCovarianceStamped_;

PoseWithCovarianceStamped_ some_stamped() {
  return from_ros2_cdr<PoseWithCovarianceStamped_>(encode(some_pose_message())).value();
}

void expect_pose_refused(std::string_view reason,
                         const std::function<void(PoseWithCovarianceStamped_&)>& corrupt) {
  PoseWithCovarianceStamped_ pose = some_stamped();
  corrupt(pose);
  expect_refused(decode_pose(to_cdr(pose)), reason);
}

TEST(Ros2Pose, RoundTripPreservesEveryField) {
  const PoseMessage sent = some_pose_message();
  const PoseMessage received = decode_pose(encode(sent)).value();
  EXPECT_EQ(received.header.stamp, sent.header.stamp);
  EXPECT_EQ(received.header.frame, sent.header.frame);
  EXPECT_EQ(received.T_a_b.p, sent.T_a_b.p);
  EXPECT_LT(received.T_a_b.R.angularDistance(sent.T_a_b.R), 1e-7);
  EXPECT_LT((received.covariance - sent.covariance).cwiseAbs().maxCoeff(), 1e-15);
}

TEST(Ros2Pose, ACovarianceOfZeroStaysZero) {
  PoseMessage pose = some_pose_message();
  pose.covariance.setZero();
  EXPECT_EQ(decode_pose(encode(pose)).value().covariance, Matrix6d::Zero());
}

TEST(Ros2Pose, WhatIsNotFiniteIsRefused) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  expect_pose_refused("not_finite", [](auto& pose) { pose.pose().pose().position().x(kNaN); });
  expect_pose_refused("not_finite", [](auto& pose) { pose.pose().pose().orientation().w(kNaN); });
  expect_pose_refused("not_finite", [](auto& pose) { pose.pose().covariance()[35] = kNaN; });
}

TEST(Ros2Pose, ValuesBeyondReasonAreRefused) {
  expect_pose_refused("out_of_range", [](auto& pose) { pose.pose().pose().position().y(1e9); });
  expect_pose_refused("out_of_range", [](auto& pose) { pose.pose().covariance()[0] = 1e13; });
}

TEST(Ros2Pose, AQuaternionFarFromUnitLengthIsRefused) {
  expect_pose_refused("not_a_rotation", [](auto& pose) { pose.pose().pose().orientation({}); });
  expect_pose_refused("not_a_rotation", [](auto& pose) {
    pose.pose().pose().orientation(to_ros2(Eigen::Quaterniond(1.02, 0.0, 0.0, 0.0)));
  });
}

TEST(Ros2Pose, AQuaternionNearUnitLengthIsNormalized) {
  PoseWithCovarianceStamped_ pose = some_stamped();
  pose.pose().pose().orientation(to_ros2(Eigen::Quaterniond(1.005, 0.0, 0.0, 0.0)));
  EXPECT_EQ(decode_pose(to_cdr(pose)).value().T_a_b.R.w(), 1.0);
}

TEST(Ros2Pose, AMatrixThatIsNoCovarianceIsRefused) {
  expect_pose_refused("not_a_covariance", [](auto& pose) { pose.pose().covariance()[1] += 0.1; });
  expect_pose_refused("not_a_covariance", [](auto& pose) { pose.pose().covariance()[0] = -0.1; });
}

}  // namespace
}  // namespace fleetloc
