#include "robot/cloud_client/cloud_client.hpp"

#include "test/pipeline/bare_localizers.hpp"

namespace fleetloc {
namespace {

using std::chrono::milliseconds;

TEST_F(CloudClientTest, DropsAndCountsSubmapsWhileThereIsNoLocalizer) {
  client_.start_session(bare_session(), at_ms(0));
  client_.submit(bare_submap(1), at_ms(0));
  EXPECT_EQ(client_.statistics().submaps_sent, 0);
  EXPECT_EQ(client_.statistics().submaps_without_localizer, 1);
}

TEST_F(CloudClientTest, ChoosesTheLeastLoadedLocalizerThatAccepts) {
  announce(*busy_, "busy", 0.9, 0);
  announce(*idle_, "idle", 0.1, 0);
  client_.start_session(bare_session(), at_ms(1));
  EXPECT_TRUE(client_.take_answers(at_ms(10)).empty());
  EXPECT_EQ(client_.statistics().localizer, "idle");
  client_.submit(bare_submap(1), at_ms(11));
  EXPECT_EQ(count(idle_->receive(at_ms(20)), Topic::kCompactSubmap), 1);
  EXPECT_EQ(count(busy_->receive(at_ms(20)), Topic::kCompactSubmap), 0);
}

TEST_F(CloudClientTest, DoesNotChooseALocalizerThatRefusesRobots) {
  announce(*idle_, "idle", 0.0, 0, false);
  static_cast<void>(client_.take_answers(at_ms(10)));
  EXPECT_EQ(client_.statistics().localizer, "");
}

TEST_F(CloudClientTest, RepeatsItsSessionUntilItIsAnswered) {
  announce(*idle_, "idle", 0.1, 0);
  client_.start_session(bare_session(), at_ms(1));
  int before = 0;
  for (int ms = 10; ms <= 3500; ms += 10) {
    static_cast<void>(client_.take_answers(at_ms(ms)));
    before += count(idle_->receive(at_ms(ms)), Topic::kSession);
  }
  EXPECT_GE(before, 3);
  idle_->send("robot", {Topic::kLocalization, encode(answer("idle", 1))}, at_ms(3500));
  static_cast<void>(client_.take_answers(at_ms(3510)));
  static_cast<void>(idle_->receive(at_ms(3510)));
  int after = 0;
  for (int ms = 3600; ms <= 6000; ms += 10) {
    static_cast<void>(client_.take_answers(at_ms(ms)));
    after += count(idle_->receive(at_ms(ms)), Topic::kSession);
  }
  EXPECT_EQ(after, 0);
}

TEST_F(CloudClientTest, AnnouncesItsSessionToItsLocalizerAndOnceToThoseThatItMayNeed) {
  announce(*idle_, "idle", 0.1, 0);
  announce(*busy_, "busy", 0.9, 0);
  client_.start_session(bare_session(), at_ms(1));
  std::vector<std::string> told;
  int announcements = 0;
  for (int ms = 10; ms <= 3500; ms += 10) {
    static_cast<void>(client_.take_answers(at_ms(ms)));
    announcements += count(idle_->receive(at_ms(ms)), Topic::kSession);
    for (const Message& message : busy_->receive(at_ms(ms))) {
      ASSERT_EQ(message.topic, Topic::kSession);
      told.push_back(decode_robot_session(message.payload).value().localizer);
    }
  }
  EXPECT_GE(announcements, 3);
  EXPECT_EQ(told, std::vector<std::string>{"idle"});
}

TEST_F(CloudClientTest, GivesARepeatedAnswerOnce) {
  announce(*idle_, "idle", 0.1, 0);
  client_.start_session(bare_session(), at_ms(1));
  static_cast<void>(client_.take_answers(at_ms(10)));
  for (int ms = 20; ms < 60; ms += 10) {
    idle_->send("robot", {Topic::kLocalization, encode(answer("idle", 7))}, at_ms(ms));
  }
  EXPECT_EQ(client_.take_answers(at_ms(100)).size(), 1);
  idle_->send("robot", {Topic::kLocalization, encode(answer("idle", 8))}, at_ms(110));
  EXPECT_EQ(client_.take_answers(at_ms(120)).size(), 1);
}

TEST_F(CloudClientTest, GivesARepeatedAnswerOnceAlsoBehindANewerOne) {
  announce(*idle_, "idle", 0.1, 0);
  client_.start_session(bare_session(), at_ms(1));
  static_cast<void>(client_.take_answers(at_ms(10)));
  for (const std::uint32_t keyframe : {7U, 8U, 7U, 8U, 7U}) {
    idle_->send("robot", {Topic::kLocalization, encode(answer("idle", keyframe))}, at_ms(20));
  }
  EXPECT_EQ(client_.take_answers(at_ms(100)).size(), 2);
}

TEST_F(CloudClientTest, KeepsTheNewestCorrectionUntilItIsTaken) {
  announce(*idle_, "idle", 0.1, 0);
  client_.start_session(bare_session(), at_ms(1));
  static_cast<void>(client_.take_answers(at_ms(10)));
  EXPECT_FALSE(client_.take_correction());
  for (const std::uint32_t anchor : {5U, 6U, 8U, 7U}) send(correction("idle", anchor), 20);
  static_cast<void>(client_.take_answers(at_ms(30)));
  EXPECT_EQ(client_.take_correction().value().anchor, KeyframeId{8});
  EXPECT_FALSE(client_.take_correction());
  send(correction("idle", 8), 40);  // the network has doubled it
  static_cast<void>(client_.take_answers(at_ms(50)));
  EXPECT_FALSE(client_.take_correction());

  send(correction("idle", 9), 60);
  static_cast<void>(client_.take_answers(at_ms(70)));
  client_.start_session(bare_session(), at_ms(80));
  EXPECT_FALSE(client_.take_correction()) << "it was of the session before";
}

TEST_F(CloudClientTest, CountsCorrectionsThatAreNotForItByName) {
  announce(*idle_, "idle", 0.1, 0);
  client_.start_session(bare_session(), at_ms(1));
  static_cast<void>(client_.take_answers(at_ms(2)));
  Correction other_robot = correction("idle", 5);
  other_robot.robot = "other";
  Correction old_session = correction("idle", 5);
  old_session.session = SessionNumber{0};
  Correction other_incarnation = correction("idle", 5);
  other_incarnation.incarnation = Incarnation{2};
  for (const Correction& unwanted :
       {other_robot, old_session, correction("busy", 5), other_incarnation}) {
    send(unwanted, 20);
  }
  static_cast<void>(client_.take_answers(at_ms(30)));
  EXPECT_FALSE(client_.take_correction());
  const auto refused = client_.statistics().refused;
  EXPECT_EQ(refused.at("other_session"), 2);
  EXPECT_EQ(refused.at("other_localizer"), 1);
  EXPECT_EQ(refused.at("other_incarnation"), 1);
}

TEST_F(CloudClientTest, AnnouncesItsSessionAgainWhenItIsAskedForWithTheNewestStartPose) {
  announce(*idle_, "idle", 0.1, 0);
  client_.start_session(bare_session(), at_ms(1));
  static_cast<void>(client_.take_answers(at_ms(10)));
  client_.submit(bare_submap(7), at_ms(20));
  idle_->send("robot", {Topic::kLocalization, encode(answer("idle", 7))}, at_ms(30));
  EXPECT_EQ(client_.take_answers(at_ms(40)).size(), 1);
  MapOdomEstimate start;
  start.T_map_odom.p.x() = 42.0;
  client_.update_start(start);
  static_cast<void>(idle_->receive(at_ms(50)));

  LocalizationResult request = answer("idle", 99);
  request.status = LocalizationStatus::kNeedFull;
  idle_->send("robot", {Topic::kLocalization, encode(request)}, at_ms(900));
  EXPECT_TRUE(client_.take_answers(at_ms(910)).empty());
  EXPECT_EQ(client_.statistics().refused.at("not_asked"), 1) << "no such submap was sent";
  EXPECT_EQ(count(idle_->receive(at_ms(910)), Topic::kSession), 0);

  client_.submit(bare_submap(8), at_ms(920));
  request.keyframe = KeyframeId{8};
  int announcements = 0;
  for (int ms = 930; ms < 1330; ms += 10) {  // many requests
    idle_->send("robot", {Topic::kLocalization, encode(request)}, at_ms(ms));
    EXPECT_TRUE(client_.take_answers(at_ms(ms)).empty());
    for (const Message& message : idle_->receive(at_ms(ms))) {
      if (message.topic != Topic::kSession) continue;
      ++announcements;
      const auto session = decode_robot_session(message.payload).value();
      EXPECT_EQ(session.start->T_map_odom.p.x(), 42.0);
      EXPECT_EQ(session.incarnation, Incarnation{1});
    }
  }
  EXPECT_EQ(announcements, 2) << "one for the request, one repetition";
}

TEST_F(CloudClientTest, IsNeitherSilencedNorMadePatientByAClockThatIsSet) {
  announce(*idle_, "idle", 0.1, 0);
  client_.start_session(bare_session(), at_ms(1));
  int samples = 0;
  int clock = 10;
  for (std::uint32_t keyframe = 0; keyframe < 60; ++keyframe) {
    if (keyframe == 20) clock += 1'000'000;
    if (keyframe == 40) clock -= 2'000'000;
    client_.submit(bare_submap(keyframe), at_ms(clock));
    if (keyframe == 19) continue;  // on its way while the clock is set
    for (int i = 0; i < 50; ++i, clock += 10) {
      static_cast<void>(client_.take_answers(at_ms(clock)));
      samples += count(idle_->receive(at_ms(3'000'000)), Topic::kCompactSubmap);
      if (i == 5) {
        LocalizationResult acknowledging = answer("idle", keyframe);
        acknowledging.acknowledgements = {.base = SampleNumber(samples - 1), .bitmap = 1};
        idle_->send("robot", {Topic::kLocalization, encode(acknowledging)}, at_ms(clock));
      }
    }
  }
  EXPECT_GT(samples, 50);
  ASSERT_TRUE(client_.statistics().round_trip);
  EXPECT_LT(to_seconds(*client_.statistics().round_trip), 2.0);
}

TEST_F(CloudClientTest, RepeatsAnAnnouncementAsItWasAndTellsTheNextLocalizerWhatIsKnownByThen) {
  RobotSession session = bare_session();
  session.start = MapOdomEstimate{.T_map_odom = {}, .p_odom = {1.0, 0.0, 0.0}};
  announce(*idle_, "idle", 0.1, 0);
  client_.start_session(session, at_ms(1));
  std::vector<double> told;
  const auto wait_and_listen = [&](Channel& end, int from_ms, int to_ms) {
    for (int ms = from_ms; ms < to_ms; ms += 10) {
      static_cast<void>(client_.take_answers(at_ms(ms)));
      for (const Message& message : end.receive(at_ms(ms))) {
        if (message.topic != Topic::kSession) continue;
        told.push_back(decode_robot_session(message.payload).value().start->p_odom.x());
      }
    }
  };
  wait_and_listen(*idle_, 10, 500);
  client_.update_start({.T_map_odom = {}, .p_odom = {2.0, 0.0, 0.0}});
  wait_and_listen(*idle_, 500, 1500);
  EXPECT_EQ(told, std::vector<double>(5, 1.0));
  told.clear();
  announce(*idle_, "idle", 0.1, 1500, false);  // goes
  announce(*busy_, "busy", 0.2, 1500);
  wait_and_listen(*busy_, 1500, 1900);
  ASSERT_FALSE(told.empty());
  EXPECT_EQ(told.back(), 2.0);
}

TEST_F(CloudClientTest, SendsItsStateToItsLocalizerOnlyWhenItHasChangedAndOtherwiseSeldom) {
  announce(*idle_, "idle", 0.1, 0);
  announce(*busy_, "busy", 0.9, 0);
  client_.start_session(bare_session(), at_ms(1));
  client_.update(Timestamp{}, Quality::kDeadReckoning);
  int states = 0;
  Quality last = Quality::kInitializing;
  for (int ms = 10; ms < 60'000; ms += 10) {
    if (ms == 35'000) client_.update(Timestamp{}, Quality::kLost);
    static_cast<void>(client_.take_answers(at_ms(ms)));
    EXPECT_EQ(count(busy_->receive(at_ms(ms)), Topic::kRobotStatus), 0);
    for (const Message& message : idle_->receive(at_ms(ms))) {
      if (message.topic != Topic::kRobotStatus) continue;
      ++states;
      last = decode_robot_status(message.payload).value().quality;
      EXPECT_EQ(last, ms < 35'000 ? Quality::kDeadReckoning : Quality::kLost);
    }
    EXPECT_TRUE(ms != 36'000 || last == Quality::kLost);
  }
  EXPECT_EQ(states, 4 + 3) << "at 0, 10, 20, 30, 35, 45 and 55 s";
}

TEST_F(CloudClientTest, CountsByNameWhatItDoesNotUse) {
  announce(*idle_, "idle", 0.1, 0);
  client_.start_session(bare_session(), at_ms(1));
  static_cast<void>(client_.take_answers(at_ms(10)));
  LocalizationResult of_old_session = answer("idle", 7);
  of_old_session.session = SessionNumber{0};
  idle_->send("robot", {Topic::kLocalization, encode(of_old_session)}, at_ms(20));
  idle_->send("robot", {Topic::kLocalization, encode(answer("busy", 7))}, at_ms(20));
  idle_->send("robot", {Topic::kLocalization, Bytes{0, 1, 0, 0, 9, 9}}, at_ms(20));
  EXPECT_TRUE(client_.take_answers(at_ms(30)).empty());
  const auto refused = client_.statistics().refused;
  EXPECT_EQ(refused.at("other_session"), 1);
  EXPECT_EQ(refused.at("other_localizer"), 1);
  EXPECT_EQ(refused.at("undecodable"), 1);
}

}  // namespace
}  // namespace fleetloc
