// Robot, protocol, link and localizer in one process and in simulated time.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "shared/geometry/so3.hpp"
#include "test/pipeline/simulated_system.hpp"

namespace fleetloc {
namespace {

/// The truth at the start, displaced by 0.3 m and 3 degrees of yaw.
Pose disturbed_start(const SimulatedRun& run) {
  const Pose yaw{exp_so3(Eigen::Vector3d(0.0, 0.0, 3.0 * M_PI / 180.0)), {}};
  Pose T = run.truth(run.frame_stamp(0)).T_odom_body;
  T.R = yaw.R * T.R;
  T.p += Eigen::Vector3d(0.2, -0.2, 0.1);
  return T;
}

class RobotAndCloud : public testing::Test {
 protected:
  static const SimulatedRun& run() {
    static const SimulatedRun run(noisy_flight());
    return run;
  }
  static std::shared_ptr<const LaserMap> map() {
    static const auto map = map_of(run());
    return map;
  }
  static double position_error(const FrameOutput& frame) {
    return (frame.pose.T_map_body->p - run().truth(frame.stamp).T_odom_body.p).norm();
  }
  static double median_error(const std::vector<FrameOutput>& frames) {
    std::vector<double> errors;
    for (const FrameOutput& frame : frames) {
      if (frame.pose.T_map_body) errors.push_back(position_error(frame));
    }
    if (errors.empty()) return INFINITY;
    std::ranges::nth_element(errors, errors.begin() + static_cast<long>(errors.size() / 2));
    return errors[errors.size() / 2];
  }
};

TEST_F(RobotAndCloud, LocalizeOverAPerfectLink) {
  SimulatedSystem system(run(), map(), perfect_link(), disturbed_start(run()));
  system.play(15.0);
  const auto applied = std::ranges::count_if(
      system.robot().answers,
      [](const LocalizationOutput& output) { return output.outcome.has_value(); });
  EXPECT_GT(applied, 10);
  const double error = median_error(system.robot().frames);
  RecordProperty("median_error_mm", static_cast<int>(1e3 * error));
  EXPECT_LT(error, 0.03);
  EXPECT_EQ(system.robot().frames.back().pose.quality, Quality::kLocalized);
}

TEST_F(RobotAndCloud, LocalizeThoughHalfOfTheDatagramsAreLost) {
  LinkConfig link = perfect_link();
  link.uplink.loss = 0.1;  // a full submap takes several datagrams
  link.downlink.loss = 0.5;
  link.uplink.delay_s = 0.2;
  link.downlink.delay_s = 0.2;
  SimulatedSystem system(run(), map(), link, disturbed_start(run()));
  system.play(15.0);
  EXPECT_LT(median_error(system.robot().frames), 0.05);
  EXPECT_GT(system.robot().client().statistics().loss, 0.0);
  ASSERT_TRUE(system.robot().client().statistics().round_trip.has_value());
  EXPECT_GE(to_seconds(*system.robot().client().statistics().round_trip), 0.4);
}

TEST_F(RobotAndCloud, OdometryGoesOnWithoutACloud) {
  LinkConfig link = perfect_link();
  link.downlink.loss = 1.0;  // no localizer is ever heard of
  SimulatedSystem system(run(), map(), link, disturbed_start(run()));
  system.play(6.0);
  EXPECT_TRUE(system.robot().answers.empty());
  EXPECT_EQ(system.robot().client().statistics().submaps_sent, 0);
  EXPECT_GT(system.robot().client().statistics().submaps_without_localizer, 0);
  EXPECT_EQ(system.robot().frames.back().pose.quality, Quality::kSearching);
  EXPECT_FALSE(system.robot().frames.back().pose.T_map_body.has_value());
}

TEST_F(RobotAndCloud, FindARobotOfWhichNobodyTellsWhereItIs) {
  const auto pyramid = make_pyramid(*map(), read_localizer_pool_config(defaults()).pyramid);
  SimulatedSystem system(run(), map(), perfect_link(), std::nullopt, pyramid);
  system.play(20.0);
  bool is_found = false;
  for (const FrameOutput& frame : system.robot().frames) {
    const Quality quality = frame.pose.quality;
    if (quality == Quality::kInitializing) continue;
    is_found = is_found || frame.pose.T_map_body.has_value();
    // The first answers, after a short way, may be too uncertain for a robot that is localized.
    const bool has_pose = quality == Quality::kLocalized || quality == Quality::kDeadReckoning;
    ASSERT_TRUE(is_found ? has_pose : quality == Quality::kSearching);
    if (is_found) {
      ASSERT_LT(position_error(frame), 0.25);
    }
  }
  EXPECT_EQ(system.robot().frames.back().pose.quality, Quality::kLocalized);
  EXPECT_LT(median_error(system.robot().frames), 0.05);
  // Turns of a search are not told one by one.
  const SessionReport report = system.pool().reports().at("robot");
  EXPECT_LE(system.robot().answers.size(), report.submaps + 1);
  EXPECT_GE(report.rejected.at("searching"), 1U);
  EXPECT_LE(report.rejected.at("searching"), report.submaps);
  EXPECT_EQ(report.search.places_left, 1U);
}

TEST_F(RobotAndCloud, GiveTheSameBitsTwice) {
  SimulatedSystem first(run(), map(), perfect_link(), disturbed_start(run()));
  SimulatedSystem second(run(), map(), perfect_link(), disturbed_start(run()));
  first.play(6.0);
  second.play(3.0);
  second.play(6.0);
  ASSERT_EQ(first.robot().frames.size(), second.robot().frames.size());
  for (std::size_t i = 0; i < first.robot().frames.size(); ++i) {
    const PoseEstimate& a = first.robot().frames[i].pose;
    const PoseEstimate& b = second.robot().frames[i].pose;
    EXPECT_EQ(a.T_odom_body.p, b.T_odom_body.p) << i;
    EXPECT_EQ(a.T_map_body.has_value(), b.T_map_body.has_value()) << i;
    if (a.T_map_body && b.T_map_body) {
      EXPECT_EQ(a.T_map_body->p, b.T_map_body->p) << i;
    }
    EXPECT_EQ(a.covariance_map, b.covariance_map) << i;
  }
}

}  // namespace
}  // namespace fleetloc
