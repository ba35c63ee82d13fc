// What the cloud is told when somebody tells where the robot is.
#include <gtest/gtest.h>

#include "test/unit/pipeline/answered_robot.hpp"

namespace fleetloc {
namespace {

using Placement = AnsweredRobot;

TEST_F(Placement, BeginsANewSessionAtOnceFromWhereTheRobotHasDrivenSince) {
  play(10.0);
  ASSERT_EQ(localizer_.sessions.size(), 1U);
  EXPECT_FALSE(localizer_.sessions[0].start);
  ASSERT_TRUE(localizer_.sessions[0].region);
  EXPECT_EQ(localizer_.sessions[0].region->name, "hall_B");
  const Pose T_odom_map = now_.T_odom_body * inverse(run_.truth(now_.stamp).T_odom_body);
  EXPECT_LT((localizer_.sessions[0].region->p_odom - T_odom_map * truth(0.0).p).norm(), 0.2)
      << "at the first image";
  pipeline_.place({.stamp = Timestamp{from_seconds(8.0)}, .T_map_body = truth(8.0)});
  ASSERT_EQ(localizer_.sessions.size(), 2U);
  EXPECT_EQ(localizer_.sessions[1].session, SessionNumber{8});
  EXPECT_FALSE(localizer_.sessions[1].region) << "somebody knows better";
  EXPECT_EQ(localizer_.sessions[1].start_stamp, localizer_.sessions[0].start_stamp);
  EXPECT_LT(start_error_m(), 0.1);
  play(12.0);
  EXPECT_EQ(now_.quality, Quality::kLocalized);
  EXPECT_EQ(pipeline_.faults().at("placements"), 1U);
  EXPECT_EQ(pipeline_.odometry().statistics().resets, 0U);
}

TEST_F(Placement, IsNoPoseThatAnAnswerCouldBeComparedWith) {
  play(10.0);
  pipeline_.place({.stamp = Timestamp{from_seconds(10.0)}, .T_map_body = truth(10.0)});
  static_cast<void>(pipeline_.take_answers());
  play(12.0);
  const auto answers = pipeline_.take_answers();
  ASSERT_GT(answers.size(), 2U);
  EXPECT_FALSE(answers.front().innovation);
  ASSERT_TRUE(answers.back().innovation);
  EXPECT_LT(answers.back().innovation->norm(), 0.05);
}

TEST_F(Placement, ByAnotherClockIsWhereTheRobotIsNow) {
  play(10.0);
  for (const Timestamp stamp : {Timestamp{}, Timestamp{std::chrono::hours(24 * 365 * 50)}}) {
    pipeline_.place({.stamp = stamp, .T_map_body = truth(10.0)});
    EXPECT_LT(start_error_m(), 0.01);
  }
  EXPECT_EQ(localizer_.sessions.back().session, SessionNumber{9});
}

TEST_F(Placement, BeforeThereIsAPoseIsTheStartOfTheFirstSession) {
  play(0.5);
  ASSERT_EQ(now_.quality, Quality::kInitializing);
  pipeline_.place({.stamp = Timestamp{from_seconds(0.5)}, .T_map_body = truth(0.5)});
  play(6.0);
  ASSERT_EQ(localizer_.sessions.size(), 1U);
  ASSERT_TRUE(localizer_.sessions[0].start);
  EXPECT_LT(start_error_m(), 0.2);
}

}  // namespace
}  // namespace fleetloc
