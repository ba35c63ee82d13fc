// One localizer and many robots: limits, shares, conflicts. Localizations themselves are left out.
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cloud/pool/localizer_pool.hpp"
#include "shared/wire/localization_result_codec.hpp"
#include "shared/wire/session_codec.hpp"
#include "shared/wire/status_codec.hpp"
#include "shared/wire/submap_codec.hpp"
#include "test/pipeline/simulated_system.hpp"

namespace fleetloc {
namespace {

Timestamp at(double s) {
  return Timestamp{from_seconds(s)};
}

RobotSession session_of(const RobotId& robot, double start_s = 1.0) {
  RobotSession session;
  session.robot = robot;
  session.session = SessionNumber{static_cast<std::uint32_t>(10.0 * start_s)};
  session.start_stamp = at(start_s);
  session.localizer = "localizer";
  session.incarnation = Incarnation{3};
  session.stereo = {
      .focal_px = 450.0, .center_px = {1024.0, 1024.0}, .baseline_m = 0.1, .T_body_cam0 = {}};
  return session;
}

Submap submap_of(const RobotSession& session, std::uint32_t number) {
  Submap submap;
  submap.robot = session.robot;
  submap.session = session.session;
  submap.incarnation = session.incarnation;
  submap.number = SampleNumber{number};
  submap.keyframes.push_back({.id = KeyframeId{number},
                              .revision = Revision{1},
                              .stamp = Timestamp{Duration{number}},
                              .T_odom_body = {},
                              .tilt_sigma = 0.01,
                              .observations = {}});
  return submap;
}

class ManyRobots : public testing::Test {
 protected:
  static LocalizerPool::Config config() { return read_localizer_pool_config(defaults()); }

  void open(const RobotSession& session, double s) {
    pool_.receive({Topic::kSession, encode(session)}, at(s));
  }
  void send(const Submap& submap, double s) {
    pool_.receive({Topic::kSubmap, encode(submap)}, at(s));
  }
  std::vector<LocalizationResult> answers(double s) {
    std::vector<LocalizationResult> answers;
    for (const auto& outgoing : pool_.outgoing(at(s), 0.0)) {
      if (outgoing.message.topic != Topic::kLocalization) continue;
      answers.push_back(decode_localization_result(outgoing.message.payload).value());
      EXPECT_EQ(outgoing.partition, answers.back().robot);
    }
    return answers;
  }
  std::uint64_t refused(const RobotId& robot, const std::string& reason) {
    const auto counts = pool_.reports().at(robot).refused;
    return counts.contains(reason) ? counts.at(reason) : 0;
  }

  std::shared_ptr<const LaserMap> map_ =
      std::make_shared<const LaserMap>(build_map({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}},
                                                 "map",
                                                 read_map_config(defaults().section("map"))));
  LocalizerPool pool_{"localizer", Incarnation{3}, map_, config()};
};

/// Robots that send twice a second, and workers whose jobs take as long as each robot's do.
class Shares : public ManyRobots {
 protected:
  struct Running {
    LocalizerPool::Job job;
    int done_ms;
  };

  static constexpr int kWarmUpMilliseconds =
      3000;  // before that, who has had nothing yet comes first

  void serve(int workers, const std::map<RobotId, int>& job_ms, int duration_ms) {
    for (const auto& [robot, ms] : job_ms) open(session_of(robot), 0.0);
    std::vector<Running> running;
    for (int ms = 0; ms < duration_ms; ++ms) {
      send_due(job_ms, ms);
      std::erase_if(running, [&](Running& one) {
        if (one.done_ms > ms) return false;
        finish(one, job_ms, ms);
        return true;
      });
      while (static_cast<int>(running.size()) < workers) {
        auto job = pool_.take_job(at(1e-3 * ms));
        if (!job) break;
        const int cost = job_ms.at(job->robot);
        running.push_back({std::move(*job), ms + cost});
      }
    }
  }

  void send_due(const std::map<RobotId, int>& job_ms, int ms) {
    int phase = 0;
    for (const auto& [robot, cost] : job_ms) {
      if ((ms + 37 * phase++) % 500 != 0) continue;
      send(submap_of(session_of(robot), static_cast<std::uint32_t>(ms)), 1e-3 * ms);
    }
  }

  void finish(const Running& one, const std::map<RobotId, int>& job_ms, int ms) {
    const double waited_s = 1e-3 * ms - to_seconds(one.job.received.time_since_epoch());
    double& longest_s = longest_s_[one.job.robot];
    if (ms > kWarmUpMilliseconds) longest_s = std::max(longest_s, waited_s);
    used_s_[one.job.robot] += 1e-3 * job_ms.at(one.job.robot);
    pool_.finish(one.job, LocalizationResult{}, 1.0, at(1e-3 * ms));
  }

  std::map<RobotId, double> longest_s_;  // from the oldest submap of a job to its answer
  std::map<RobotId, double> used_s_;
};

TEST_F(Shares, TwoSlowRobotsDelayTheOthersByOneJobOnly) {
  std::map<RobotId, int> job_ms{{"slow_1", 800}, {"slow_2", 800}};
  for (int i = 0; i < 8; ++i) job_ms["robot_" + std::to_string(i)] = 20;
  serve(1, job_ms, 60'000);
  for (const auto& [robot, longest_s] : longest_s_) {
    if (job_ms.at(robot) == 20) {
      EXPECT_LE(longest_s, 0.8 + 2 * 8 * 0.02) << robot;
    }
  }
  EXPECT_NEAR(used_s_["slow_1"], used_s_["slow_2"], 2.0);
  EXPECT_GT(used_s_["slow_1"], 15.0) << "what the others leave is used";
}

TEST_F(Shares, ASlowRobotOccupiesOneWorkerOnly) {
  std::map<RobotId, int> job_ms{{"slow", 3000}};
  for (int i = 0; i < 8; ++i) job_ms["robot_" + std::to_string(i)] = 20;
  serve(2, job_ms, 30'000);
  for (const auto& [robot, longest_s] : longest_s_) {
    if (robot != "slow") {
      EXPECT_LE(longest_s, 8 * 0.02 + 0.01) << robot;
    }
  }
}

TEST_F(Shares, AllGetTheSameWhenTheWorkersAreOverloaded) {
  std::map<RobotId, int> job_ms;
  for (int i = 0; i < 5; ++i) job_ms["quick_" + std::to_string(i)] = 250;
  for (int i = 0; i < 5; ++i) job_ms["slow_" + std::to_string(i)] = 500;
  serve(1, job_ms, 120'000);
  for (const auto& [robot, used_s] : used_s_) EXPECT_NEAR(used_s, 12.0, 1.5) << robot;
}

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
  EXPECT_THAT(pool_.take_departed(), testing::ElementsAre("a"));
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
  for (int i = 0; i < 5000; ++i) {
    send(submap_of(session_of("stranger_" + std::to_string(i)), 0), 0.0);
  }
  EXPECT_LE(answers(0.1).size(), 256);
  static_cast<void>(answers(20.0));
  EXPECT_EQ(pool_.take_departed().size(), 256);
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
  EXPECT_EQ(rejected.status, LocalizationStatus::kNoStartPose);
  pool_.finish(*job, std::move(rejected), 1.0, at(0.2));
  session.start = MapOdomEstimate{};
  open(session, 0.3);
  send(submap_of(session, 1), 0.4);
  job = pool_.take_job(at(0.4));
  LocalizationResult answer = LocalizerPool::run(*job);
  EXPECT_NE(answer.status, LocalizationStatus::kNoStartPose);
  answer.status = LocalizationStatus::kLocalized;
  pool_.finish(*job, std::move(answer), 1.0, at(0.5));
  const auto localizer = job->session;
  session.start->T_map_odom.p.x() += 1.0;
  open(session, 0.6);
  send(submap_of(session, 2), 0.7);
  job = pool_.take_job(at(0.7));
  EXPECT_EQ(job->session, localizer) << "it knows better";
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
