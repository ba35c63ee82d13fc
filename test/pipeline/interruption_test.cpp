// Nothing stops the robot: it gives poses whatever becomes of the cloud, says what they are worth,
// and is localized again soon after there is service.
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "shared/geometry/angle.hpp"
#include "test/pipeline/interruptible_system.hpp"

namespace fleetloc {
namespace {

using testing::Contains;
using testing::HasSubstr;

constexpr double kSoonSeconds = 5.0;

class Interruption : public testing::Test {
 protected:
  static const SimulatedRun& run() {
    static const SimulatedRun run(noisy_flight());
    return run;
  }
  static std::shared_ptr<const LaserMap> map() {
    static const auto map = map_of(run());
    return map;
  }
  /// The same room elsewhere: poses in it would be wrong by half a metre.
  static std::shared_ptr<const LaserMap> other_map() {
    std::vector<Eigen::Vector3f> points;
    for (const Eigen::Vector3d& p : run().surface_points(0.03)) {
      points.emplace_back((p + Eigen::Vector3d(0.5, 0.0, 0.0)).cast<float>());
    }
    return std::make_shared<const LaserMap>(
        build_map(points, "other", read_map_config(defaults().section("map"))));
  }
  static Pose start() {
    Pose T = run().truth(run().frame_stamp(0)).T_odom_body;
    T.p += Eigen::Vector3d(0.2, -0.2, 0.1);
    return T;
  }

  [[nodiscard]] double first_applied_after(double since_s) const {
    for (const LocalizationOutput& answer : system_.robot().answers) {
      const double arrival_s = to_seconds(answer.arrival.time_since_epoch());
      if (answer.outcome && arrival_s > since_s) return arrival_s;
    }
    return INFINITY;
  }
  [[nodiscard]] int applied_between(double from_s, double to_s) const {
    return static_cast<int>(
        std::ranges::count_if(system_.robot().answers, [&](const LocalizationOutput& answer) {
          const double arrival_s = to_seconds(answer.arrival.time_since_epoch());
          return answer.outcome && arrival_s > from_s && arrival_s <= to_s;
        }));
  }
  [[nodiscard]] Quality quality_at(double s) const {
    const auto frame = std::ranges::find_if(system_.robot().frames, [&](const FrameOutput& output) {
      return to_seconds(output.stamp.time_since_epoch()) >= s - 1e-6;
    });
    return frame->pose.quality;
  }
  /// Every frame has a pose in odom once there was one, and in the map once there was one.
  void expect_poses_throughout() const {
    bool has_odom = false;
    bool has_map = false;
    for (const FrameOutput& frame : system_.robot().frames) {
      const bool odom = frame.pose.quality != Quality::kInitializing;
      const bool in_map = frame.pose.T_map_body.has_value();
      const double s = to_seconds(frame.stamp.time_since_epoch());
      EXPECT_TRUE(odom || !has_odom) << s;
      EXPECT_TRUE(in_map || !has_map) << s;
      has_odom = has_odom || odom;
      has_map = has_map || in_map;
      if (in_map) {
        const Vector6d error =
            local_coordinates(*frame.pose.T_map_body, run().truth(frame.stamp).T_odom_body);
        EXPECT_LT(error.tail<3>().norm(), 0.25) << s;
        EXPECT_LT(error.head<3>().norm(), 2.0 * kRadPerDeg) << s;
      }
    }
    EXPECT_TRUE(has_map);
  }

  InterruptibleSystem system_{run(), start()};
};

TEST_F(Interruption, NoLocalizerAtTheStart) {
  system_.play(8.0);
  EXPECT_EQ(quality_at(7.9), Quality::kSearching);
  EXPECT_EQ(system_.robot().client().statistics().localizer, "");
  system_.start("a", 1, map());
  system_.play(13.0);
  EXPECT_LT(first_applied_after(8.0), 8.0 + kSoonSeconds);
  EXPECT_EQ(system_.robot().frames.back().pose.quality, Quality::kLocalized);
  expect_poses_throughout();
}

TEST_F(Interruption, ALocalizerThatDiesForTenSeconds) {
  system_.start("a", 1, map());
  system_.play(8.0);
  EXPECT_GT(applied_between(0.0, 8.0), 5);
  system_.kill("a");
  system_.play(18.0);
  EXPECT_EQ(applied_between(8.5, 18.0), 0);
  EXPECT_EQ(quality_at(17.9), Quality::kLocalized) << "ten seconds of odometry are within 0.25 m";
  system_.start("a", 2, map());
  system_.play(23.0);
  EXPECT_LT(first_applied_after(18.0), 18.0 + kSoonSeconds);
  EXPECT_EQ(system_.robot().answers.back().answer.incarnation, Incarnation{2});
  EXPECT_EQ(system_.robot().frames.back().pose.quality, Quality::kLocalized);
  EXPECT_THAT(system_.robot().events, Contains(HasSubstr("restarted")));
  EXPECT_LT(system_.robot().client().statistics().loss, 0.5) << "numbers of the new incarnation";
  expect_poses_throughout();
}

TEST_F(Interruption, ALocalizerThatHangsWhileThereIsAnother) {
  system_.start("a", 1, map());
  system_.play(8.0);
  system_.start("b", 7, map());
  system_.hang("a");
  system_.play(20.0);
  EXPECT_LT(first_applied_after(8.2), 8.0 + kSoonSeconds);
  EXPECT_EQ(system_.robot().client().statistics().localizer, "b");
  EXPECT_EQ(system_.robot().client().statistics().localizers_chosen, 2)
      << "does not go back and forth";
  EXPECT_EQ(system_.robot().frames.back().pose.quality, Quality::kLocalized);
  expect_poses_throughout();
}

TEST_F(Interruption, ALocalizerThatNeverAnswersUntilThereIsAnother) {
  system_.start("a", 1, map());
  system_.hang("a");
  system_.play(8.0);
  EXPECT_EQ(system_.robot().client().statistics().localizer, "a");
  EXPECT_TRUE(system_.robot().answers.empty());
  EXPECT_EQ(quality_at(7.9), Quality::kSearching);
  EXPECT_THAT(system_.robot().events,
              Contains(HasSubstr("a does not answer, and there is no other")));
  system_.start("b", 1, map());
  system_.play(13.0);
  EXPECT_LT(first_applied_after(8.0), 8.0 + kSoonSeconds);
  expect_poses_throughout();
}

TEST_F(Interruption, NoNetworkForAMinute) {
  system_.start("a", 1, map());
  system_.play(8.0);
  system_.cut(true);
  system_.play(68.0);
  EXPECT_EQ(applied_between(8.0, 68.0), 0);
  EXPECT_EQ(quality_at(67.9), Quality::kDeadReckoning);
  system_.cut(false);
  system_.play(73.0);
  EXPECT_LT(first_applied_after(68.0), 68.0 + kSoonSeconds);
  EXPECT_EQ(system_.robot().frames.back().pose.quality, Quality::kLocalized);
  expect_poses_throughout();
}

TEST_F(Interruption, ACloudThatIsRestartedWithAnotherMap) {
  system_.start("a", 1, map());
  system_.play(8.0);
  system_.kill("a");
  system_.play(9.0);
  system_.start("a", 2, other_map());
  system_.play(18.0);
  EXPECT_EQ(applied_between(8.2, 18.0), 0);
  EXPECT_EQ(quality_at(17.9), Quality::kLocalized) << "in the map that it had";
  EXPECT_EQ(system_.robot().client().statistics().localizer, "");
  EXPECT_THAT(system_.robot().events,
              Contains(HasSubstr("localizer a is refused: it has another map")));
  system_.start("a", 3, map());
  system_.play(23.0);
  EXPECT_LT(first_applied_after(18.0), 18.0 + kSoonSeconds);
  EXPECT_EQ(system_.robot().frames.back().pose.quality, Quality::kLocalized);
  expect_poses_throughout();
}

TEST_F(Interruption, ALocalizerThatHasForgottenTheSessionAsksForIt) {
  system_.start("a", 1, map(), "pool: {idle_session_s: 2.0}");
  system_.play(6.0);
  system_.cut(true);
  system_.play(11.0);
  EXPECT_EQ(system_.pool("a").sessions(), 0);
  system_.cut(false);
  system_.play(16.0);
  EXPECT_GT(system_.robot().client().statistics().sessions_requested, 0);
  EXPECT_LT(first_applied_after(11.0), 11.0 + kSoonSeconds);
  expect_poses_throughout();
}

}  // namespace
}  // namespace fleetloc
