#include "robot/cloud_client/session_announcer.hpp"

#include <gtest/gtest.h>

#include "test/unit/timestamps.hpp"

namespace fleetloc {
namespace {

MapOdomEstimate start_at(double x) {
  MapOdomEstimate start;
  start.T_map_odom.p.x() = x;
  return start;
}

double start_of(const RobotSession& session) {
  return session.start->T_map_odom.p.x();
}

class SessionAnnouncerTest : public testing::Test {
 protected:
  SessionAnnouncerTest() {
    RobotSession session;
    session.start = start_at(1.0);
    announcer_.start(session);
  }
  const RobotSession& announce(double s, std::uint32_t incarnation = 1) {
    return announcer_.announcement("localizer", Incarnation{incarnation}, at(s));
  }

  SessionAnnouncer announcer_{{.interval_s = 1.0, .max_interval_s = 4.0, .min_interval_s = 0.5}};
};

TEST_F(SessionAnnouncerTest, RepeatsEverMoreRarelyUntilThereIsAnAnswer) {
  announce(0.0);
  std::vector<double> repeated_s;
  for (int tenths = 0; tenths < 200; ++tenths) {
    if (announcer_.repetition(at(0.1 * tenths))) repeated_s.push_back(0.1 * tenths);
  }
  ASSERT_GE(repeated_s.size(), 8);
  EXPECT_NEAR(repeated_s[0], 1.0, 0.01);
  EXPECT_NEAR(repeated_s[1] - repeated_s[0], 1.25, 0.11);
  EXPECT_NEAR(repeated_s[2] - repeated_s[1], 1.5625, 0.11);
  EXPECT_NEAR(repeated_s.back() - repeated_s[repeated_s.size() - 2], 4.0, 0.11);
  announcer_.answered();
  EXPECT_FALSE(announcer_.repetition(at(100.0)).has_value());
}

TEST_F(SessionAnnouncerTest, RepetitionsKeepTheStartAndRequestsGetTheNewest) {
  EXPECT_EQ(start_of(announce(0.0)), 1.0);
  announcer_.update_start(start_at(2.0));
  EXPECT_EQ(start_of(announcer_.repetition(at(1.0)).value()), 1.0);
  EXPECT_EQ(start_of(announcer_.requested(at(2.0)).value()), 2.0);
  announcer_.update_start(start_at(3.0));
  const RobotSession& restarted = announce(3.0, 2);
  EXPECT_EQ(start_of(restarted), 3.0);
  EXPECT_EQ(restarted.incarnation, Incarnation{2});
}

TEST_F(SessionAnnouncerTest, ARegionIsToldUntilThereIsAStart) {
  RobotSession session;
  session.region = StartRegion{.name = "hall_B"};
  announcer_.start(session);
  EXPECT_TRUE(announce(0.0).region);
  EXPECT_TRUE(announcer_.requested(at(2.0)).value().region);
  announcer_.update_start(start_at(2.0));
  EXPECT_TRUE(announcer_.repetition(at(3.0)).value().region) << "the same as before";
  EXPECT_FALSE(announce(4.0).region);
}

TEST_F(SessionAnnouncerTest, ARequestIsNotObeyedTooOften) {
  announce(0.0);
  EXPECT_FALSE(announcer_.requested(at(0.4)).has_value());
  EXPECT_TRUE(announcer_.requested(at(0.5)).has_value());
  EXPECT_FALSE(announcer_.requested(at(0.6)).has_value());
}

TEST_F(SessionAnnouncerTest, ARequestEndsTheSilenceAfterAnAnswer) {
  announce(0.0);
  announcer_.answered();
  EXPECT_FALSE(announcer_.repetition(at(10.0)).has_value());
  EXPECT_TRUE(announcer_.requested(at(10.0)).has_value());
  EXPECT_TRUE(announcer_.repetition(at(11.0)).has_value());
}

TEST_F(SessionAnnouncerTest, AStartThatCannotBeEncodedIsDropped) {
  announce(0.0);
  announcer_.drop_start();
  EXPECT_FALSE(announcer_.repetition(at(1.0)).value().start.has_value());
  EXPECT_FALSE(announce(2.0).start.has_value());
}

}  // namespace
}  // namespace fleetloc
