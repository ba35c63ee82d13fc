#include "cloud/pool/localizer_pool.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "shared/wire/session_codec.hpp"
#include "shared/wire/submap_codec.hpp"
#include "test/answer_bytes.hpp"
#include "test/pipeline/simulated_system.hpp"
#include "test/unit/timestamps.hpp"

namespace fleetloc {
namespace {

using std::chrono::milliseconds;

RobotSession pool_session(const RobotId& robot, std::uint32_t number = 1) {
  RobotSession session;
  session.robot = robot;
  session.session = SessionNumber{number};
  session.localizer = "localizer";
  session.incarnation = Incarnation{3};
  session.stereo = {
      .focal_px = 450.0, .center_px = {1024.0, 1024.0}, .baseline_m = 0.1, .T_body_cam0 = {}};
  return session;
}

Submap pool_submap(const RobotId& robot, std::uint32_t number, std::uint32_t session = 1) {
  Submap submap;
  submap.robot = robot;
  submap.session = SessionNumber{session};
  submap.incarnation = Incarnation{3};
  submap.number = SampleNumber{number};
  submap.keyframes.push_back({.id = KeyframeId{number},
                              .revision = Revision{1},
                              .stamp = at_ms(static_cast<int>(number)),
                              .T_odom_body = {},
                              .tilt_sigma = 0.01,
                              .observations = {}});
  return submap;
}

class LocalizerPoolTest : public testing::Test {
 protected:
  void open(const RobotSession& session) {
    pool_.receive({Topic::kSession, encode(session)}, at_ms(0));
  }
  void send(const Submap& submap) { pool_.receive({Topic::kSubmap, encode(submap)}, at_ms(0)); }
  SessionReport report(const RobotId& robot) { return pool_.reports().at(robot); }

  std::vector<LocalizationResult> answers(int ms) {
    std::vector<LocalizationResult> answers;
    for (const auto& outgoing : pool_.outgoing(at_ms(ms), 0.0)) {
      if (outgoing.message.topic != Topic::kLocalization) continue;
      answers.push_back(decode_localization_result(outgoing.message.payload).value());
      EXPECT_EQ(outgoing.partition, answers.back().robot);
    }
    return answers;
  }

  void run_job(int ms) {
    auto job = pool_.take_job(at_ms(ms));
    ASSERT_TRUE(job.has_value());
    LocalizationResult answer = LocalizerPool::run(*job);
    pool_.finish(*job, std::move(answer), 1.0, at_ms(ms));
  }

  std::shared_ptr<const LaserMap> map_ =
      std::make_shared<const LaserMap>(build_map({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}},
                                                 "map",
                                                 read_map_config(defaults().section("map"))));
  LocalizerPool pool_{"localizer", Incarnation{3}, map_, read_localizer_pool_config(defaults())};
};

TEST_F(LocalizerPoolTest, AnswersWithItsNameIncarnationMapAndAcknowledgements) {
  open(pool_session("a"));
  send(pool_submap("a", 0));
  send(pool_submap("a", 2));
  run_job(40);
  const auto sent = answers(50);
  ASSERT_EQ(sent.size(), 1);
  EXPECT_EQ(sent[0].localizer, "localizer");
  EXPECT_EQ(sent[0].incarnation, Incarnation{3});
  EXPECT_EQ(sent[0].map_hash, map_->info().hash);
  EXPECT_EQ(sent[0].acknowledgements.bitmap, 0b101U);
  EXPECT_EQ(sent[0].holding_time, milliseconds(50));
  EXPECT_EQ(sent[0].status, LocalizationStatus::kSearching);
  EXPECT_EQ(report("a").rejected.at("searching"), 1);
}

TEST_F(LocalizerPoolTest, SaysThatARobotBeginsInARegionThatTheMapDoesNotHave) {
  LocalizerPool pool("localizer",
                     Incarnation{3},
                     map_,
                     read_localizer_pool_config(defaults()),
                     nullptr,
                     {{"hall_B", MapRegion::circle({1.0, 1.0}, 5.0)}});
  const auto events_of = [&pool](const RobotId& robot, const std::string& region) {
    RobotSession session = pool_session(robot);
    session.region = StartRegion{.name = region};
    pool.receive({Topic::kSession, encode(session)}, at_ms(0));
    return pool.take_events();
  };
  EXPECT_THAT(events_of("a", "hall_B"), testing::ElementsAre("a: session 1 opened"));
  EXPECT_THAT(
      events_of("b", "hall_C"),
      testing::Contains("b: begins in region 'hall_C', which the map does not have: it is not "
                        "searched for"));
}

TEST_F(LocalizerPoolTest, RepeatsTheAnswerUntilThereIsANewerOne) {
  open(pool_session("a"));
  send(pool_submap("a", 0));
  run_job(0);
  int sent = 0;
  for (int ms = 0; ms <= 5000; ms += 10) sent += static_cast<int>(answers(ms).size());
  EXPECT_GE(sent, 5);
  EXPECT_LE(sent, 26);
}

TEST_F(LocalizerPoolTest, ServesRobotsInTurnAndEachOneJobAtATime) {
  for (const char* robot : {"a", "b", "c"}) {
    open(pool_session(robot));
    send(pool_submap(robot, 0));
  }
  const auto first = pool_.take_job(at_ms(0));
  ASSERT_TRUE(first.has_value());
  EXPECT_EQ(first->robot, "a");
  send(pool_submap("a", 1));
  EXPECT_EQ(pool_.take_job(at_ms(0))->robot, "b");
  EXPECT_EQ(pool_.take_job(at_ms(0))->robot, "c");
  EXPECT_FALSE(pool_.take_job(at_ms(0)).has_value());  // a waits, but its job is still running
  pool_.finish(*first, LocalizationResult{}, 1.0, at_ms(1));
  EXPECT_EQ(pool_.take_job(at_ms(0))->robot, "a");
}

TEST_F(LocalizerPoolTest, RefusesByNameWhatDoesNotBelongToTheSession) {
  open(pool_session("a", 2));
  send(pool_submap("a", 0, 1));
  send(pool_submap("a", 0, 2));
  send(pool_submap("a", 0, 2));
  open(pool_session("a", 1));  // an old datagram
  EXPECT_EQ(report("a").submaps, 1);
  EXPECT_EQ(report("a").refused.at("unknown_session"), 1);
  EXPECT_EQ(report("a").refused.at("seen_before"), 1);
  EXPECT_EQ(report("a").refused.at("outdated_session"), 1);
}

TEST_F(LocalizerPoolTest, UsesWhatCameBeforeTheSession) {
  const RobotSession session = pool_session("a");
  for (const std::uint32_t number : {0U, 2U}) {
    const Submap submap = pool_submap("a", number);
    pool_.receive({Topic::kCompactSubmap, encode_compact(submap, {}, {}, session.stereo)},
                  at_ms(0));
  }
  open(session);
  EXPECT_EQ(report("a").submaps, 2);
  run_job(0);
  EXPECT_EQ(answers(0).at(0).acknowledgements.bitmap, 0b101U);
}

TEST_F(LocalizerPoolTest, AResultOfAReplacedSessionIsDropped) {
  open(pool_session("a", 1));
  send(pool_submap("a", 0, 1));
  const auto job = pool_.take_job(at_ms(0));
  ASSERT_TRUE(job.has_value());
  open(pool_session("a", 2));
  pool_.finish(*job, LocalizationResult{}, 1.0, at_ms(1));
  EXPECT_TRUE(answers(2).empty());
}

TEST_F(LocalizerPoolTest, GarbageHarmsNobody) {
  open(pool_session("a"));
  for (const Topic topic : {Topic::kSession, Topic::kSubmap}) {
    pool_.receive({topic, Bytes{}}, at_ms(0));
    pool_.receive({topic, Bytes{0, 1, 0, 0, 255, 255, 255, 255}}, at_ms(0));
  }
  pool_.receive({Topic::kSubmap, encode(pool_submap("unknown_robot", 0))}, at_ms(0));
  send(pool_submap("a", 0));
  EXPECT_EQ(report("a").submaps, 1);
  EXPECT_EQ(pool_.sessions(), 1);
}

TEST_F(LocalizerPoolTest, DropsTheOldestOfTooManyWaitingSubmaps) {
  open(pool_session("a"));
  for (std::uint32_t i = 0; i < 70; ++i) send(pool_submap("a", i));
  const auto job = pool_.take_job(at_ms(0));
  ASSERT_TRUE(job.has_value());
  EXPECT_EQ(job->submaps.size(), 64);
  EXPECT_EQ(job->submaps.back().number, SampleNumber{69});
  EXPECT_EQ(report("a").refused.at("overtaken"), 6);
}

}  // namespace
}  // namespace fleetloc
