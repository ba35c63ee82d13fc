#include "robot/vio/stereo_odometry.hpp"

#include <gtest/gtest.h>

#include "robot/vio/pose_alignment.hpp"
#include "test/unit/vio/simulated_vio.hpp"

namespace fleetloc {
namespace {

double drift_after(const SimulatedRun& run, int frames) {
  StereoOdometry odometry(run.stereo(), simulated_vio_config(0.5).initializer.odometry);
  const Pose T_first_room = inverse(run.truth(run.frame_stamp(0)).T_odom_body);
  Vector6d error = Vector6d::Constant(1e9);
  for (int i = 0; i < frames; ++i) {
    const auto T_first_body = odometry.add(run.frame(i));
    if (!T_first_body.has_value()) {
      return 1e9;
    }
    error =
        local_coordinates(T_first_room * run.truth(run.frame_stamp(i)).T_odom_body, *T_first_body);
  }
  return error.norm();
}

TEST(StereoOdometry, IsExactWithoutNoise) {
  EXPECT_LT(drift_after(SimulatedRun(SimulatedRun::Config{}), 30), 1e-6);
}

TEST(StereoOdometry, BearsNoiseAndOutliers) {
  SimulatedRun::Config config;
  config.pixel_sigma = 0.5;
  config.outlier_share = 0.1;
  EXPECT_LT(drift_after(SimulatedRun(config), 30), 0.1);
}

TEST(StereoOdometry, SaysSoWhenNothingMatches) {
  const SimulatedRun run(SimulatedRun::Config{});
  StereoOdometry odometry(run.stereo(), simulated_vio_config(0.5).initializer.odometry);
  EXPECT_TRUE(odometry.add(run.frame(0)).has_value());
  EXPECT_FALSE(odometry.add({run.frame_stamp(1), {}}).has_value());
  EXPECT_TRUE(odometry.add(run.frame(2)).has_value());
}

TEST(PoseAlignment, LeavesOutWhatIsBeyondTheLimit) {
  const SimulatedRun run(SimulatedRun::Config{});
  const TrackedFrame frame = run.frame(0);
  const Pose T_room_body = run.truth(frame.stamp).T_odom_body;
  std::vector<KnownPoint> points;
  for (const StereoObservation& seen : frame.observations) {
    points.push_back({run.landmark(seen.landmark), seen, 1.0});
  }
  points.front().observation.left.x() += 30.0;
  const PoseSystem with = linearize(points, run.stereo(), T_room_body, {2.0, 1e9});
  const PoseSystem without = linearize(points, run.stereo(), T_room_body, {2.0, 5.0});
  EXPECT_EQ(with.inliers, without.inliers + 1);
  EXPECT_GT(with.g.norm(), 1.0);
  EXPECT_LT(without.g.norm(), 1e-6);
}

}  // namespace
}  // namespace fleetloc
