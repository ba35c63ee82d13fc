#include "shared/protocol/session_register.hpp"

#include <gtest/gtest.h>

#include "test/unit/timestamps.hpp"

namespace fleetloc {
namespace {

constexpr std::string_view kAccepted = "accepted";

std::string_view outcome(SessionRegister::Acceptance acceptance) {
  return acceptance ? kAccepted : name(acceptance.error());
}

RobotSession session(double start_s, std::uint32_t number, const RobotId& robot = "robot") {
  RobotSession result;
  result.robot = robot;
  result.start_stamp = at(start_s);
  result.session = SessionNumber{number};
  return result;
}

RobotStatus status(double start_s, std::uint32_t number) {
  RobotStatus result;
  result.robot = "robot";
  result.start_stamp = at(start_s);
  result.session = SessionNumber{number};
  return result;
}

class SessionRegisterTest : public testing::Test {
 protected:
  std::string_view announce(double start_s, std::uint32_t number, double now_s) {
    return outcome(sessions_.announced(session(start_s, number), at(now_s)));
  }
  std::string_view submap(std::uint32_t number, double now_s) {
    return outcome(sessions_.submap("robot", SessionNumber{number}, at(now_s)));
  }

  SessionRegister sessions_{{.settling_s = 5.0, .silence_s = 20.0, .max_robots = 3}};
};

TEST_F(SessionRegisterTest, TakesTheFirstSessionOfARobot) {
  EXPECT_EQ(submap(1, 0), "unknown_session");
  EXPECT_EQ(announce(10, 1, 0), kAccepted);
  EXPECT_EQ(announce(10, 1, 1), kAccepted);
  EXPECT_EQ(submap(1, 1), kAccepted);
  EXPECT_EQ(submap(2, 1), "unknown_session");
}

TEST_F(SessionRegisterTest, AResetOfTheOdometryReplacesTheSessionWithoutAConflict) {
  announce(10, 1, 0);
  EXPECT_EQ(announce(10, 2, 1), kAccepted);
  EXPECT_EQ(submap(2, 2), kAccepted);
  EXPECT_EQ(submap(1, 2), "outdated_session");
  EXPECT_EQ(submap(1, 10), "outdated_session");
  EXPECT_EQ(announce(10, 1, 10), "outdated_session");
}

TEST_F(SessionRegisterTest, ARestartedRobotReplacesTheSessionThoughItsNumberIsLower) {
  announce(10, 7, 0);
  EXPECT_EQ(announce(11, 1, 1), kAccepted);
  EXPECT_EQ(submap(1, 2), kAccepted);
  EXPECT_EQ(submap(7, 2), "outdated_session");
}

TEST_F(SessionRegisterTest, AnOldSampleDoesNotBringAnOldSessionBack) {
  announce(11, 1, 0);
  EXPECT_EQ(announce(10, 7, 1), "outdated_session");
  EXPECT_EQ(submap(1, 2), kAccepted);
}

TEST_F(SessionRegisterTest, WhatTheOlderOfTwoRobotsStillSendsIsAConflict) {
  announce(10, 1, 0);
  announce(11, 2, 1);
  for (int s = 1; s < 60; ++s) {
    EXPECT_EQ(submap(2, s), kAccepted);
    const std::string_view expected = s <= 6 ? "outdated_session" : "conflicting_session";
    EXPECT_EQ(submap(1, s), expected) << s;
    EXPECT_EQ(announce(10, 1, s), expected) << s;
    EXPECT_EQ(outcome(sessions_.status(status(10, 1), at(s))), expected) << s;
    EXPECT_EQ(outcome(sessions_.status(status(11, 2), at(s))), kAccepted);
  }
}

TEST_F(SessionRegisterTest, ASilentSessionGivesWayToARobotWhoseClockWasSetBack) {
  announce(1000, 1, 0);
  EXPECT_EQ(announce(10, 2, 19), "conflicting_session");
  EXPECT_EQ(announce(10, 2, 21), kAccepted);
  EXPECT_EQ(submap(2, 22), kAccepted);
  EXPECT_EQ(submap(1, 23), "outdated_session");
}

TEST_F(SessionRegisterTest, ForgetsTheRobotThatWasHeardLeastRecentlyWhenItIsFull) {
  for (int i = 0; i < 4; ++i) {
    sessions_.announced(session(10, 1, "robot_" + std::to_string(i)), at(i == 0 ? 50 : i));
  }
  EXPECT_EQ(sessions_.robots(), 3);
  EXPECT_EQ(outcome(sessions_.submap("robot_1", SessionNumber{1}, at(60))), "unknown_session");
  EXPECT_EQ(outcome(sessions_.submap("robot_0", SessionNumber{1}, at(60))), kAccepted);
}

}  // namespace
}  // namespace fleetloc
