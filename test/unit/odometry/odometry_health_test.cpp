#include "robot/odometry/odometry_health.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "shared/geometry/so3.hpp"
#include "test/unit/timestamps.hpp"

namespace fleetloc {
namespace {

constexpr OdometryHealth::Config kConfig{.max_vision_lost_s = 3.0,
                                         .max_velocity_sigma = 0.5,
                                         .max_speed = 20.0,
                                         .max_gyroscope_bias = 0.3,
                                         .max_accelerometer_bias = 1.5};

WindowEstimate healthy_window() {
  WindowEstimate window;
  window.keyframes.resize(1);
  window.keyframes.back().stamp = at(1.0);
  window.diagnostics.converged = true;
  return window;
}

FrameEstimator::Result frame(double seconds, bool vision_updated) {
  FrameEstimator::Result result;
  result.estimate.stamp = at(seconds);
  result.estimate.covariance.setIdentity();
  result.estimate.covariance *= 1e-4;
  result.vision_updated = vision_updated;
  return result;
}

/// The cause for a reset, if there is one.
template <typename Checked>
std::optional<ResetCause> check(OdometryHealth& health, const Checked& checked) {
  const auto healthy = health.check(checked);
  return healthy ? std::nullopt : std::optional(healthy.error());
}

TEST(OdometryHealth, FindsNothingWrongWithAHealthyOdometry) {
  OdometryHealth health(kConfig);
  EXPECT_EQ(check(health, healthy_window()), std::nullopt);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(check(health, frame(1.0 + 0.1 * i, true)), std::nullopt);
}

TEST(OdometryHealth, BridgesBlindFramesForALimitedTime) {
  OdometryHealth health(kConfig);
  health.check(healthy_window());
  EXPECT_EQ(check(health, frame(3.9, false)), std::nullopt);
  EXPECT_EQ(check(health, frame(4.1, false)), ResetCause::kVisionLost);
  health.reset();  // and starts again
  EXPECT_EQ(check(health, healthy_window()), std::nullopt);
  EXPECT_EQ(check(health, frame(3.9, true)), std::nullopt);
  EXPECT_EQ(check(health, frame(6.8, false)), std::nullopt);
  EXPECT_EQ(check(health, frame(7.0, false)), ResetCause::kVisionLost);
}

TEST(OdometryHealth, DistrustsAWindowThatDidNotConvergeOrHasImplausibleBiases) {
  OdometryHealth health(kConfig);
  WindowEstimate window = healthy_window();
  window.diagnostics.converged = false;
  EXPECT_EQ(check(health, window), ResetCause::kDiverged);
  window = healthy_window();
  window.keyframes.back().state.bias.gyroscope.x() = 0.4;
  EXPECT_EQ(check(health, window), ResetCause::kImplausibleBias);
  window = healthy_window();
  window.keyframes.back().state.bias.accelerometer.z() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(check(health, window), ResetCause::kImplausibleBias);
  window = healthy_window();
  window.keyframes.back().state.v_odom.x() = 30.0;
  EXPECT_EQ(check(health, window), ResetCause::kDiverged);
}

TEST(OdometryHealth, DoesNotMindThatTheYawInOdomIsHardlyKnown) {
  OdometryHealth health(kConfig);
  health.check(healthy_window());
  FrameEstimator::Result drifted = frame(1.1, true);
  drifted.estimate.state.v_odom = {3.0, -1.0, 0.5};
  drifted.estimate.state.T_odom_body.R = exp_so3({0.3, -0.5, 1.0});
  Eigen::Matrix<double, 9, 1> yaw = Eigen::Matrix<double, 9, 1>::Zero();  // turns pose and velocity
  yaw.head<3>() = drifted.estimate.state.T_odom_body.R.conjugate() * Eigen::Vector3d::UnitZ();
  yaw.tail<3>() = Eigen::Vector3d::UnitZ().cross(drifted.estimate.state.v_odom);
  drifted.estimate.covariance.topLeftCorner<9, 9>() += yaw * yaw.transpose();
  ASSERT_GT(drifted.estimate.covariance(7, 7), 1.0);
  EXPECT_EQ(check(health, drifted), std::nullopt);
}

TEST(OdometryHealth, DistrustsAVelocityThatIsHardlyKnown) {
  OdometryHealth health(kConfig);
  health.check(healthy_window());
  FrameEstimator::Result uncertain = frame(1.1, true);
  uncertain.estimate.covariance(7, 7) = 0.3;
  EXPECT_EQ(check(health, uncertain), ResetCause::kUncertain);
  uncertain.estimate.covariance(7, 7) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(check(health, uncertain), ResetCause::kUncertain);
}

}  // namespace
}  // namespace fleetloc
