#include "deploy/monitor/watched_run.hpp"

#include <cmath>
#include <fstream>

#include <gmock/gmock.h>

#include "test/unit/run_folder/written_run.hpp"

namespace fleetloc {
namespace {

constexpr double kError_m = 0.05;

/// The robot moves along y at 1 m/s; the estimate lies beside.
Trajectory truth() {
  Trajectory trajectory;
  for (int i = 0; i <= 200; ++i) {
    const double seconds = 0.1 * i;
    trajectory.push_back(
        {at(seconds), {.R = Eigen::Quaterniond::Identity(), .p = {kError_m, seconds, 0.0}}});
  }
  return trajectory;
}

/// At 10 Hz, with 2 KB/s up and half of that down.
FrameRecord localized_frame(int i) {
  FrameRecord record = frame(0.1 * i, Quality::kLocalized);
  record.pose.covariance_map.setIdentity();
  record.pose.covariance_map.diagonal().tail<3>() << 1e-4, 9e-4, 4e-4;
  record.uplink_bytes = 200 * static_cast<std::uint64_t>(i);
  record.downlink_bytes = 100 * static_cast<std::uint64_t>(i);
  record.round_trip = std::chrono::milliseconds(450);
  return record;
}

TEST(WatchedRun, KnowsNothingBeforeThereIsARun) {
  WatchedRun run(test_folder() / "later" / "robot_7", truth());
  const RobotView view = run.update();
  EXPECT_EQ(view.name, "robot_7");
  EXPECT_EQ(view.state, "");
  EXPECT_TRUE(std::isnan(view.time_s));
  EXPECT_FALSE(view.ended);
}

TEST(WatchedRun, FollowsARunUntilItsEnd) {
  const auto folder = test_folder() / "followed" / "robot_1";
  WatchedRun run(folder, truth());
  RunFolder written(folder);
  written.add_frame(frame(0.0, Quality::kInitializing));
  EXPECT_EQ(run.update().state, "initializing");
  EXPECT_TRUE(std::isnan(run.update().error_m));
  for (int i = 1; i <= 100; ++i) written.add_frame(localized_frame(i));
  const RobotView view = run.update();
  EXPECT_EQ(view.state, "localized");
  EXPECT_NEAR(view.time_s, 10.0, 1e-6);
  EXPECT_NEAR(view.error_m, kError_m, 1e-6);
  EXPECT_NEAR(view.sigma_m, 0.03, 1e-6);
  EXPECT_NEAR(view.uplink_kb_s, 2.0, 1e-6);
  EXPECT_NEAR(view.downlink_kb_s, 1.0, 1e-6);
  EXPECT_NEAR(view.round_trip_s, 0.45, 1e-6);
  EXPECT_FALSE(view.ended);
  written.finish({});
  EXPECT_TRUE(run.update().ended);
}

TEST(WatchedRun, HasNoErrorWithoutGroundTruth) {
  const auto folder = test_folder() / "without_truth";
  RunFolder written(folder);
  for (int i = 0; i < 10; ++i) written.add_frame(localized_frame(i));
  WatchedRun run(folder, {});
  EXPECT_EQ(run.update().state, "localized");
  EXPECT_TRUE(std::isnan(run.update().error_m));
}

TEST(WatchedLocalizer, ShowsItsLatestLine) {
  const auto folder = test_folder() / "localizer_1";
  std::filesystem::create_directories(folder);
  WatchedLocalizer localizer(folder);
  EXPECT_EQ(localizer.update().sessions, "");
  std::ofstream(folder / "status.csv")
      << "time_s,sessions,load,submaps,localized,state\n0.5,0,0,0,0,accepting\n"
      << "1.5,2,0.25,12,9,full\n";
  const LocalizerView view = localizer.update();
  EXPECT_EQ(view.name, "localizer_1");
  EXPECT_EQ(view.state, "full");
  EXPECT_EQ(view.sessions, "2");
  EXPECT_DOUBLE_EQ(view.load, 0.25);
  EXPECT_EQ(view.submaps, "12");
  EXPECT_EQ(view.localized, "9");
}

}  // namespace
}  // namespace fleetloc
