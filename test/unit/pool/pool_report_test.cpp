#include "cloud/pool/pool_report.hpp"

#include <gtest/gtest.h>

#include "test/unit/timestamps.hpp"

namespace fleetloc {
namespace {

TEST(PoolReport, CountsRefusalsByRobotWhileItIsServed) {
  PoolReport report(10);
  report.open("a");
  report.refuse("a", PoolRefusal::kSeenBefore, at(0));
  report.refuse("b", PoolRefusal::kTooManySessions, at(0));
  report.refuse(Malformed::kNotFinite);
  EXPECT_EQ(report.reports().at("a").refused.at("seen_before"), 1);
  EXPECT_EQ(report.unattributed().at("too_many_sessions"), 1);
  EXPECT_EQ(report.unattributed().at("not_finite"), 1);
}

TEST(PoolReport, ContinuesTheReportOfARobotThatComesBack) {
  PoolReport report(10);
  report.open("a");
  report.of("a").submaps = 5;
  report.close("a", "it went", at(1));
  EXPECT_EQ(report.reports().at("a").submaps, 5);
  report.open("a");
  EXPECT_EQ(report.of("a").submaps, 5);
}

TEST(PoolReport, KeepsTheRobotsThatWereHeardLast) {
  PoolReport report(2);
  for (const char* robot : {"a", "b", "c"}) report.open(robot);
  report.close("a", "", at(3));
  report.close("b", "", at(1));
  report.close("c", "", at(2));
  EXPECT_TRUE(report.reports().contains("a"));
  EXPECT_FALSE(report.reports().contains("b"));
  EXPECT_TRUE(report.reports().contains("c"));
}

TEST(PoolReport, AConflictIsAnEventOnceUntilItIsOver) {
  PoolReport report(10);
  for (int s = 0; s < 100; ++s) {
    report.refuse("a", PoolRefusal::kConflictingSession, at(s));
    report.clean_up(at(s));
  }
  EXPECT_EQ(report.take_events().size(), 1);
  report.clean_up(at(131));
  report.refuse("a", PoolRefusal::kConflictingSession, at(131));
  EXPECT_EQ(report.take_events().size(), 1);
}

TEST(PoolReport, IsBounded) {
  PoolReport report(3);
  for (int i = 0; i < 2000; ++i) {
    const RobotId robot = "robot_" + std::to_string(i);
    report.open(robot);
    report.close(robot, "", at(i));
  }
  EXPECT_EQ(report.reports().size(), 3);
  EXPECT_EQ(report.take_events().size(), 1000);
}

}  // namespace
}  // namespace fleetloc
