#include "shared/protocol/session_rule.hpp"

#include <gtest/gtest.h>

namespace fleetloc {
namespace {

RobotSession session(int start_s, std::uint32_t number) {
  RobotSession result;
  result.start_stamp = Timestamp{std::chrono::seconds(start_s)};
  result.session = SessionNumber{number};
  return result;
}

TEST(SessionRule, TakesTheFirstSessionOfARobot) {
  EXPECT_EQ(judge(std::nullopt, session(10, 1)), SessionVerdict::kReplaces);
}

TEST(SessionRule, KnowsARepeatedSample) {
  EXPECT_EQ(judge(session(10, 1), session(10, 1)), SessionVerdict::kRepeated);
}

TEST(SessionRule, AResetOfTheOdometryReplacesTheSession) {
  EXPECT_EQ(judge(session(10, 1), session(10, 2)), SessionVerdict::kReplaces);
}

TEST(SessionRule, ARestartedRobotReplacesTheSessionThoughItsNumberIsLower) {
  EXPECT_EQ(judge(session(10, 7), session(11, 1)), SessionVerdict::kReplaces);
}

TEST(SessionRule, AnOldSampleDoesNotBringAnOldSessionBack) {
  EXPECT_EQ(judge(session(10, 2), session(10, 1)), SessionVerdict::kOutdated);
  EXPECT_EQ(judge(session(11, 1), session(10, 7)), SessionVerdict::kOutdated);
}

}  // namespace
}  // namespace fleetloc
