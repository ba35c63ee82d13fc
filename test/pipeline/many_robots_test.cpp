// One localizer and many robots: limits, shares, conflicts. Localizations themselves are left out.
#include "test/pipeline/many_robots.hpp"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "shared/wire/status_codec.hpp"

namespace fleetloc {
namespace {

TEST_F(ManyRobots, AThousandAreServedAndNoMore) {
  for (int i = 0; i < 1001; ++i) open(session_of("robot_" + std::to_string(i)), 0.0);
  EXPECT_EQ(pool_.sessions(), 1000);
  EXPECT_EQ(pool_.unattributed().at("too_many_sessions"), 1);
  for (int i = 0; i < 1001; ++i) send(submap_of(session_of("robot_" + std::to_string(i)), 0), 0.1);
  int jobs = 0;
  while (auto job = pool_.take_job(at(0.2))) {
    pool_.finish(*job, LocalizationResult{}, 1.0, at(0.2));
    ++jobs;
  }
  EXPECT_EQ(jobs, 1000);
  for (const auto& outgoing : pool_.outgoing(at(0.3), 0.0)) {
    if (outgoing.message.topic != Topic::kLocalizerStatus) continue;
    EXPECT_FALSE(decode_localizer_status(outgoing.message.payload).value().accepting);
  }
}

TEST_F(ManyRobots, ASilentRobotMakesRoomAndItsReportIsKept) {
  const RobotSession session = session_of("a");
  open(session, 0.0);
  send(submap_of(session, 0), 0.0);
  open(session_of("b"), 100.0);
  static_cast<void>(answers(119.0));
  EXPECT_EQ(pool_.sessions(), 2);
  static_cast<void>(answers(121.5));
  EXPECT_EQ(pool_.sessions(), 1);
  EXPECT_EQ(pool_.reports().at("a").submaps, 1);
  open(session, 122.0);
  send(submap_of(session, 1), 122.0);
  EXPECT_EQ(pool_.reports().at("a").submaps, 2);
}

TEST_F(ManyRobots, ARobotThatGoesToAnotherLocalizerHasLeft) {
  RobotSession session = session_of("a");
  open(session, 0.0);
  send(submap_of(session, 0), 0.0);
  const auto job = pool_.take_job(at(0.1));
  ASSERT_TRUE(job.has_value());
  session.localizer = "other";
  open(session, 0.2);
  EXPECT_EQ(pool_.sessions(), 0);
  pool_.finish(*job, LocalizationResult{}, 1.0, at(0.3));
  EXPECT_TRUE(answers(0.4).empty());
}

TEST_F(ManyRobots, AsksForASessionThatItDoesNotKnowButNotTooOften) {
  const RobotSession session = session_of("a");
  int asked = 0;
  for (std::uint32_t i = 0; i < 100; ++i) {
    send(submap_of(session, i), 0.1 * i);
    for (const LocalizationResult& answer : answers(0.1 * i)) {
      EXPECT_EQ(answer.status, LocalizationStatus::kNeedFull);
      EXPECT_EQ(answer.session, session.session);
      EXPECT_EQ(answer.keyframe, KeyframeId{i});
      ++asked;
    }
  }
  EXPECT_GE(asked, 10);
  EXPECT_LE(asked, 20);
  open(session, 10.0);
  send(submap_of(session, 200), 10.0);
  EXPECT_TRUE(answers(10.0).empty());
  EXPECT_EQ(pool_.reports().at("a").submaps, 1);
}

TEST_F(ManyRobots, UnknownRobotsTakeABoundedPlaceAndAreForgotten) {
  const auto strangers_come = [&](int s) {
    for (int i = 0; i < 5000; ++i) {
      const std::string robot = "stranger_" + std::to_string(s) + "_" + std::to_string(i);
      send(submap_of(session_of(robot), 0), s);
    }
    return answers(s).size();
  };
  EXPECT_EQ(strangers_come(1), 256);
  EXPECT_EQ(strangers_come(2), 0) << "there is no place left";
  static_cast<void>(answers(20.0));
  EXPECT_EQ(strangers_come(21), 256);
}

TEST_F(ManyRobots, SubmapsAndSessionsForAnEarlierStartOfTheLocalizerDoNotCount) {
  RobotSession session = session_of("a");
  session.incarnation = Incarnation{2};
  open(session, 0.0);
  EXPECT_EQ(pool_.sessions(), 0);
  send(submap_of(session, 0), 0.1);
  const auto asked = answers(0.2);
  ASSERT_EQ(asked.size(), 1);
  EXPECT_EQ(asked[0].incarnation, Incarnation{3});
}

TEST_F(ManyRobots, ARestartedRobotIsAcceptedWithoutAConflict) {
  open(session_of("a", 1.0), 0.0);
  send(submap_of(session_of("a", 1.0), 0), 1.0);
  open(session_of("a", 2.0), 2.0);
  send(submap_of(session_of("a", 1.0), 1), 2.1);  // was on its way
  send(submap_of(session_of("a", 2.0), 0), 2.2);
  EXPECT_EQ(pool_.reports().at("a").submaps, 2);
  EXPECT_EQ(refused("a", "outdated_session"), 1);
  EXPECT_EQ(refused("a", "conflicting_session"), 0);
}

TEST_F(ManyRobots, OfTwoLiveRobotsWithOneIdTheEarlierIsRefusedAndNamed) {
  const RobotSession first = session_of("a", 1.0);
  const RobotSession second = session_of("a", 2.0);
  open(first, 0.0);
  open(second, 1.0);
  std::uint32_t number = 0;
  for (int half_seconds = 2; half_seconds < 42; ++half_seconds) {
    const double s = 0.5 * half_seconds;
    open(first, s);
    send(submap_of(first, number), s);
    send(submap_of(second, number++), s);
  }
  EXPECT_EQ(pool_.reports().at("a").submaps, 40);
  EXPECT_GE(refused("a", "conflicting_session"), 50);
  const auto events = pool_.take_events();
  EXPECT_EQ(std::ranges::count_if(events,
                                  [](const std::string& event) {
                                    return event.find("two robots have this id") !=
                                           std::string::npos;
                                  }),
            1)
      << "once, not per message";
}

TEST_F(ManyRobots, ANewerStartPoseIsTakenUntilTheRobotIsLocalized) {
  RobotSession session = session_of("a");
  open(session, 0.0);
  send(submap_of(session, 0), 0.1);
  auto job = pool_.take_job(at(0.1));
  LocalizationResult rejected = LocalizerPool::run(*job);
  EXPECT_EQ(rejected.status, LocalizationStatus::kSearching);
  pool_.finish(*job, std::move(rejected), 1.0, at(0.2));
  session.start = MapOdomEstimate{};
  open(session, 0.3);
  send(submap_of(session, 1), 0.4);
  job = pool_.take_job(at(0.4));
  LocalizationResult answer = LocalizerPool::run(*job);
  EXPECT_NE(answer.status, LocalizationStatus::kSearching);
  answer.status = LocalizationStatus::kLocalized;
  pool_.finish(*job, std::move(answer), 1.0, at(0.5));
  const auto localizer = job->session;
  session.start->T_map_odom.p.x() += 1.0;
  open(session, 0.6);
  send(submap_of(session, 2), 0.7);
  job = pool_.take_job(at(0.7));
  EXPECT_EQ(job->session, localizer) << "it knows better";
}

TEST_F(ManyRobots, ANewerStartPoseLosesNothingThatWasAcknowledged) {
  RobotSession session = session_of("a");
  open(session, 0.0);
  for (std::uint32_t i = 0; i < 5; ++i) send(submap_of(session, i), 0.1);
  auto job = pool_.take_job(at(0.1));
  LocalizationResult rejected = LocalizerPool::run(*job);
  pool_.finish(*job, std::move(rejected), 1.0, at(0.2));
  for (const double x : {1.0, 2.0}) {  // the second comes before there was work
    session.start = MapOdomEstimate{};
    session.start->T_map_odom.p.x() = x;
    open(session, 0.3);
  }
  send(submap_of(session, 5), 0.4);
  job = pool_.take_job(at(0.4));
  LocalizerPool::run(*job);
  EXPECT_EQ(job->session->database().keyframes().size(), 6);
}

TEST_F(ManyRobots, WorkThatHasWaitedTooLongIsDroppedAndCounted) {
  const RobotSession session = session_of("a");
  open(session, 0.0);
  for (std::uint32_t i = 0; i < 3; ++i) send(submap_of(session, i), 0.1 * i);
  EXPECT_FALSE(pool_.take_job(at(10.0)).has_value());
  EXPECT_EQ(refused("a", "stale"), 3);
}

TEST_F(ManyRobots, TheStateOfARobotIsReported) {
  const RobotSession session = session_of("a");
  open(session, 0.0);
  RobotStatus status;
  status.robot = "a";
  status.session = session.session;
  status.start_stamp = session.start_stamp;
  status.quality = Quality::kDeadReckoning;
  pool_.receive({Topic::kRobotStatus, encode(status)}, at(1.0));
  ASSERT_TRUE(pool_.reports().at("a").status.has_value());
  EXPECT_EQ(pool_.reports().at("a").status->quality, Quality::kDeadReckoning);
}

TEST(RecentValues, KeepTheLatest) {
  RecentValues values;
  for (int i = 0; i < 2500; ++i) values.add(i);
  EXPECT_EQ(values.values().size(), RecentValues::kMax);
  EXPECT_EQ(std::ranges::min(values.values()), 1500);
  EXPECT_EQ(std::ranges::max(values.values()), 2499);
}

}  // namespace
}  // namespace fleetloc
