#include <set>

#include "robot/cloud_client/cloud_client.hpp"
#include "shared/compact/submap_sample.hpp"
#include "test/pipeline/bare_localizers.hpp"

namespace fleetloc {
namespace {

TEST_F(CloudClientTest, TellsTheLocalizerThatItLeavesWhereItGoes) {
  announce(*idle_, "idle", 0.1, 0);
  client_.start_session(bare_session(), at_ms(1));
  static_cast<void>(client_.take_answers(at_ms(10)));
  static_cast<void>(idle_->receive(at_ms(10)));
  drain(*idle_, "idle", 20);
  announce(*busy_, "busy", 0.9, 20);
  static_cast<void>(client_.take_answers(at_ms(30)));
  ASSERT_EQ(client_.statistics().localizer, "idle") << "until the other one answers";
  EXPECT_EQ(count(idle_->receive(at_ms(30)), Topic::kSession), 0);
  busy_->send("robot", {Topic::kLocalization, encode(answer("busy", 1))}, at_ms(35));
  EXPECT_EQ(client_.take_answers(at_ms(36)).size(), 1);
  ASSERT_EQ(client_.statistics().localizer, "busy");
  const auto last_words = idle_->receive(at_ms(40));
  ASSERT_EQ(count(last_words, Topic::kSession), 1);
  EXPECT_EQ(decode_robot_session(last_words.front().payload).value().localizer, "busy");
}

TEST_F(CloudClientTest, BringsTheNextOneEverythingWhileADrainingOneAnswers) {
  announce(*idle_, "idle", 0.1, 0);
  client_.start_session(bare_session(), at_ms(1));
  const auto keyframe = [](std::uint32_t i) {
    Submap submap = bare_submap(i);
    submap.keyframes[0].stamp = at_ms(static_cast<int>(i));
    return submap;
  };
  for (std::uint32_t i = 1; i <= 5; ++i) {
    client_.submit(keyframe(i), at_ms(static_cast<int>(100 * i)));
    static_cast<void>(client_.take_answers(at_ms(static_cast<int>(100 * i + 50))));
  }
  const auto localize = [](Channel& end, const std::string& localizer, std::uint32_t i, int ms) {
    LocalizationResult localized = answer(localizer, i);
    localized.status = LocalizationStatus::kLocalized;
    localized.covariance = 1e-4 * Matrix6d::Identity();
    end.send("robot", {Topic::kLocalization, encode(localized)}, at_ms(ms));
  };
  localize(*idle_, "idle", 5, 600);
  EXPECT_EQ(client_.take_answers(at_ms(610)).size(), 1);
  static_cast<void>(idle_->receive(at_ms(610)));
  client_.update_start({.T_map_odom = {}, .p_odom = {2.0, 0.0, 0.0}});
  announce(*busy_, "busy", 0.9, 620);
  drain(*idle_, "idle", 620);
  static_cast<void>(client_.take_answers(at_ms(630)));
  client_.submit(keyframe(6), at_ms(700));
  for (int ms = 710; ms < 1100; ms += 10) static_cast<void>(client_.take_answers(at_ms(ms)));
  EXPECT_GE(count(idle_->receive(at_ms(1100)), Topic::kCompactSubmap), 1) << "it still answers";
  std::set<KeyframeId> brought;
  for (const Message& message : busy_->receive(at_ms(1100))) {
    if (message.topic == Topic::kSession) {
      EXPECT_EQ(decode_robot_session(message.payload).value().start->p_odom.x(), 2.0);
    }
    if (message.topic != Topic::kCompactSubmap) continue;
    const SubmapSample sample = decode_submap_sample(message.payload).value();
    const Submap submap = decode_submap(sample, bare_session().stereo).value();
    for (const SubmapKeyframe& one : submap.keyframes) brought.insert(one.id);
  }
  EXPECT_EQ(brought.size(), 6);

  busy_->send("robot", {Topic::kLocalization, encode(answer("busy", 6))}, at_ms(1110));
  EXPECT_TRUE(client_.take_answers(at_ms(1120)).empty()) << "no pose, where the old one has one";
  EXPECT_EQ(client_.statistics().localizer, "idle");
  localize(*idle_, "idle", 6, 1130);
  EXPECT_EQ(client_.take_answers(at_ms(1140)).size(), 1) << "the old one still counts";
  localize(*busy_, "busy", 6, 1150);
  EXPECT_EQ(client_.take_answers(at_ms(1160)).size(), 1);
  EXPECT_EQ(client_.statistics().localizer, "busy");
}

TEST_F(CloudClientTest, ALocalizerThatItComesBackToGetsNoNumberTwice) {
  announce(*idle_, "idle", 0.1, 0);
  client_.start_session(bare_session(), at_ms(1));
  int ms = 20;
  const auto play_until = [&](int end) {
    for (; ms < end; ms += 20) {
      if (ms % 100 == 0 && ms <= 3000) {
        client_.submit(bare_submap(static_cast<std::uint32_t>(ms / 100)), at_ms(ms));
      }
      if (ms % 500 == 0) {
        idle_->send("robot", {Topic::kLocalization, encode(answer("idle", 1))}, at_ms(ms));
      }
      static_cast<void>(client_.take_answers(at_ms(ms)));
    }
  };
  play_until(20'000);  // then nothing is left to be sent to it
  announce(*busy_, "busy", 0.9, ms);
  drain(*idle_, "idle", ms);
  play_until(23'000);
  drain(*busy_, "busy", ms);
  play_until(23'100);
  EXPECT_EQ(client_.statistics().successors, 1);
  announce(*busy_, "busy", 0.9, ms);
  play_until(36'000);
  EXPECT_EQ(client_.statistics().successors, 2) << "nothing was tried";
  EXPECT_EQ(client_.statistics().localizer, "idle");
  std::set<SampleNumber> numbers;
  std::size_t samples = 0;
  for (const Message& message : busy_->receive(at_ms(36'000))) {
    if (message.topic != Topic::kCompactSubmap) continue;
    numbers.insert(decode_submap_sample(message.payload).value().number);
    ++samples;
  }
  EXPECT_GT(samples, 10);
  EXPECT_EQ(numbers.size(), samples);
}

TEST_F(CloudClientTest, WithANewSessionTheHandoverBeginsAnew) {
  announce(*idle_, "idle", 0.1, 0);
  client_.start_session(bare_session(), at_ms(1));
  client_.submit(bare_submap(1), at_ms(10));
  announce(*busy_, "busy", 0.9, 20);
  drain(*idle_, "idle", 20);
  static_cast<void>(client_.take_answers(at_ms(30)));
  RobotSession next = bare_session();
  next.session = SessionNumber{2};
  static_cast<void>(busy_->receive(at_ms(35)));
  client_.start_session(next, at_ms(40));
  static_cast<void>(client_.take_answers(at_ms(50)));
  std::vector<std::pair<SessionNumber, std::string>> told;
  for (const Message& message : busy_->receive(at_ms(60))) {
    if (message.topic != Topic::kSession) continue;
    const RobotSession session = decode_robot_session(message.payload).value();
    told.emplace_back(session.session, session.localizer);
  }
  EXPECT_EQ(told.back(), (std::pair{SessionNumber{2}, std::string("busy")}));
}

}  // namespace
}  // namespace fleetloc
