#include "robot/vio/frame_estimator.hpp"

#include <cmath>
#include <cstdint>

#include <Eigen/Eigenvalues>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/unit/vio/simulated_vio.hpp"

namespace fleetloc {
namespace {

using testing::IsEmpty;
using testing::Not;

// A window with true states, and frames after it.
class FrameEstimatorTest : public testing::Test {
 protected:
  static SimulatedRun::Config noisy() {
    SimulatedRun::Config config;
    config.imu_white_noise = true;
    config.pixel_sigma = 0.5;
    return config;
  }
  FrameEstimatorTest() {
    for (const ImuSample& sample : run_.imu(run_.frame_stamp(0), run_.frame_stamp(200))) {
      imu_.add(sample);
    }
    const SlidingWindow window(
        run_.stereo(), run_.noise(), config_.window, true_initialization(run_, 40, 8, 6));
    window_ = std::make_shared<WindowEstimate>(window.estimate());
  }

  SimulatedRun run_{noisy()};
  VioConfig config_ = simulated_vio_config(0.5);
  ImuBuffer imu_;
  std::shared_ptr<const WindowEstimate> window_;
  static constexpr int kNewest = 40 + 7 * 6;
};

TEST_F(FrameEstimatorTest, NeedsAWindowAndTheImu) {
  FrameEstimator estimator(run_.stereo(), run_.noise(), config_.frame_estimator);
  EXPECT_FALSE(estimator.estimate(run_.frame(kNewest + 1), imu_).has_value());
  estimator.update(window_);
  EXPECT_FALSE(estimator.estimate(run_.frame(kNewest - 1), imu_).has_value());
  EXPECT_FALSE(estimator.estimate(run_.frame(kNewest + 1), ImuBuffer{}).has_value());
  EXPECT_TRUE(estimator.estimate(run_.frame(kNewest), imu_).has_value());
  EXPECT_TRUE(estimator.estimate(run_.frame(kNewest + 1), imu_).has_value());
}

TEST_F(FrameEstimatorTest, VisionImprovesThePrediction) {
  FrameEstimator estimator(run_.stereo(), run_.noise(), config_.frame_estimator);
  estimator.update(window_);
  const int frame = kNewest + 10;
  const auto with = estimator.estimate(run_.frame(frame), imu_);
  const auto without = estimator.estimate({run_.frame_stamp(frame), {}}, imu_);
  ASSERT_TRUE(with.has_value() && without.has_value());
  EXPECT_GT(with->tracked, 30);
  EXPECT_EQ(without->tracked, 0);
  const Vector6d moved_with = local_coordinates(with->estimate.state.T_odom_body,
                                                run_.truth(run_.frame_stamp(frame)).T_odom_body);
  EXPECT_LT(moved_with.tail<3>().norm(), 0.02);
  EXPECT_LT(moved_with.head<3>().norm(), 0.01);
  EXPECT_LT(with->estimate.covariance.trace(), without->estimate.covariance.trace());
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix15d>(with->estimate.covariance).eigenvalues()(0),
            0.0);
}

TEST_F(FrameEstimatorTest, SurvivesOutliers) {
  SimulatedRun::Config config = noisy();
  config.outlier_share = 0.2;
  const SimulatedRun spoiled(config);
  FrameEstimator estimator(run_.stereo(), run_.noise(), config_.frame_estimator);
  estimator.update(window_);
  const int frame = kNewest + 5;
  const auto result = estimator.estimate(spoiled.frame(frame), imu_);
  ASSERT_TRUE(result.has_value());
  EXPECT_THAT(result->outliers, Not(IsEmpty()));
  EXPECT_LT(
      (result->estimate.state.T_odom_body.p - run_.truth(run_.frame_stamp(frame)).T_odom_body.p)
          .norm(),
      0.03);
}

TEST_F(FrameEstimatorTest, WantsAKeyframeWhenTimeOrTracksRunOut) {
  FrameEstimator estimator(run_.stereo(), run_.noise(), config_.frame_estimator);
  estimator.update(window_);
  EXPECT_FALSE(estimator.estimate(run_.frame(kNewest + 1), imu_)->wants_keyframe);  // too soon
  int wanted = kNewest + 2;
  while (!estimator.estimate(run_.frame(wanted), imu_)->wants_keyframe) {
    ++wanted;
  }
  EXPECT_LE(to_seconds(run_.frame_stamp(wanted) - run_.frame_stamp(kNewest)),
            config_.frame_estimator.max_keyframe_interval_s + 1e-9);
  // It is wanted again until it is made.
  const auto again = estimator.estimate(run_.frame(wanted + 1), imu_);
  EXPECT_TRUE(again->wants_keyframe);
  estimator.set_reference_keyframe(run_.frame(wanted), again->estimate.state);
  // That frame is what the next ones are compared with, though the window does not have it yet.
  EXPECT_FALSE(estimator.estimate(run_.frame(wanted + 1), imu_)->wants_keyframe);
  TrackedFrame renamed = run_.frame(wanted + 4);  // every track was lost, and others were found
  for (StereoObservation& seen : renamed.observations) {
    seen.landmark = LandmarkId{static_cast<std::uint32_t>(seen.landmark) + 1'000'000};
  }
  EXPECT_TRUE(estimator.estimate(renamed, imu_)->wants_keyframe);
}

TEST_F(FrameEstimatorTest, CarriesOnInertiallyWithoutImagesAndMakesThemNoKeyframes) {
  FrameEstimator estimator(run_.stereo(), run_.noise(), config_.frame_estimator);
  estimator.update(window_);
  const int frame = kNewest + 20;
  const auto inertial_only = estimator.estimate({run_.frame_stamp(frame), {}}, imu_);
  ASSERT_TRUE(inertial_only.has_value());
  EXPECT_FALSE(inertial_only->vision_updated);
  EXPECT_FALSE(inertial_only->vision_inconsistent);
  EXPECT_FALSE(inertial_only->wants_keyframe);
  const Eigen::Vector3d error = inertial_only->estimate.state.T_odom_body.p -
                                run_.truth(run_.frame_stamp(frame)).T_odom_body.p;
  EXPECT_LT(error.norm(),
            3.0 * std::sqrt(inertial_only->estimate.covariance.diagonal().segment<3>(3).sum()));
}

TEST_F(FrameEstimatorTest, TrustsNoImageOfLongAgo) {
  FrameEstimator estimator(run_.stereo(), run_.noise(), config_.frame_estimator);
  estimator.update(window_);
  const int frame = kNewest + 6;
  TrackedFrame frozen = run_.frame(kNewest + 1);
  frozen.stamp = run_.frame_stamp(frame);
  const auto result = estimator.estimate(frozen, imu_);
  ASSERT_TRUE(result.has_value());
  EXPECT_TRUE(result->vision_inconsistent);
  EXPECT_FALSE(result->vision_updated);
  EXPECT_FALSE(result->wants_keyframe);
  EXPECT_LT(
      (result->estimate.state.T_odom_body.p - run_.truth(run_.frame_stamp(frame)).T_odom_body.p)
          .norm(),
      0.05);
  const auto honest = estimator.estimate(run_.frame(frame), imu_);
  EXPECT_TRUE(honest->vision_updated);
  EXPECT_LT(honest->correction_chi_square, 25.0);
}

}  // namespace
}  // namespace fleetloc
