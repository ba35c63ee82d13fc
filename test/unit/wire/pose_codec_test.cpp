#include "shared/wire/pose_codec.hpp"

#include <limits>

#include <idl/pose.h>

#include "test/unit/wire/samples.hpp"

namespace fleetloc {
namespace {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

void expect_pose_refused(Malformed reason,
                         const std::function<void(wire::PoseEstimate&)>& corrupt) {
  expect_refused<wire::PoseEstimate>(some_pose_estimate(), decode_pose_estimate, reason, corrupt);
}

TEST(PoseCodec, RoundTripPreservesEveryField) {
  const RobotPoseEstimate pose = some_pose_estimate();
  const PoseEstimate& sent = pose.estimate;
  const auto decoded = decode_pose_estimate(encode(pose)).value();
  const PoseEstimate& received = decoded.estimate;
  EXPECT_EQ(decoded.robot, pose.robot);
  EXPECT_EQ(received.stamp, sent.stamp);
  EXPECT_EQ(received.quality, sent.quality);
  EXPECT_EQ(received.since_last_answer, sent.since_last_answer);
  expect_near(received.T_odom_body, sent.T_odom_body, 1e-15, 0.0);
  expect_near(received.covariance_odom, sent.covariance_odom, 1e-6);
  ASSERT_TRUE(received.T_map_body);
  expect_near(*received.T_map_body, *sent.T_map_body, 1e-15, 0.0);
  expect_near(received.covariance_map, sent.covariance_map, 1e-6);
  EXPECT_EQ(received.v_odom, sent.v_odom);
  EXPECT_EQ(received.angular_velocity, sent.angular_velocity);
}

TEST(PoseCodec, RoundTripPreservesTheLackOfAMapPose) {
  RobotPoseEstimate pose = some_pose_estimate();
  pose.estimate.T_map_body.reset();
  const auto received = decode_pose_estimate(encode(pose)).value();
  EXPECT_FALSE(received.estimate.T_map_body);
  EXPECT_TRUE(received.estimate.covariance_map.isZero());
}

TEST(PoseCodec, RefusesWithAReason) {
  using enum Malformed;
  expect_pose_refused(kInvalidId, [](auto& sample) { sample.robot(""); });
  expect_pose_refused(kUnknownValue,
                      [](auto& sample) { sample.quality(static_cast<wire::Quality>(77)); });
  expect_pose_refused(kOutOfRange, [](auto& sample) {
    sample.since_last_answer_ns(std::numeric_limits<std::int64_t>::min());
  });
  expect_pose_refused(kNotFinite,
                      [](auto& sample) { sample.T_odom_body().translation().x(kNoNumber); });
  expect_pose_refused(kNotARotation, [](auto& sample) { sample.T_map_body().rotation().z(1.1); });
  expect_pose_refused(kOutOfRange, [](auto& sample) { sample.covariance_odom().R()[0] = 1e12F; });
  expect_pose_refused(kOutOfRange, [](auto& sample) { sample.covariance_map().R()[0] = 1e12F; });
  expect_pose_refused(kNotFinite, [](auto& sample) { sample.v_odom().x(kNoNumber); });
  expect_pose_refused(kOutOfRange, [](auto& sample) { sample.angular_velocity().x(1e4); });
}

}  // namespace
}  // namespace fleetloc
