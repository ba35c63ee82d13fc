#include "robot/cloud_client/session_streams.hpp"

#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "deploy/config/default_config.hpp"
#include "robot/cloud_client/cloud_client.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/wire/session_codec.hpp"

namespace fleetloc {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;

SessionStreams::Time both_at(double s) {
  const Timestamp now{from_seconds(s)};
  return {now, now};
}

Submap submap_of(std::uint32_t keyframe) {
  Submap submap;
  submap.keyframes.push_back({.id = KeyframeId{keyframe},
                              .revision = Revision{1},
                              .stamp = both_at(0.5 * keyframe).now,
                              .T_odom_body = {},
                              .tilt_sigma = 0.01,
                              .observations = {}});
  return submap;
}

/// Writes down to whom sessions and submaps are sent: "a: session to b", "a: submap".
class RecordingChannel final : public Channel {
 public:
  void send(const std::string& receiver, Message message, Timestamp /*now*/) override {
    sent.push_back(receiver + ": " +
                   (message.topic == Topic::kSession
                        ? "session to " + decode_robot_session(message.payload).value().localizer
                        : "submap"));
  }
  [[nodiscard]] std::vector<Message> receive(Timestamp /*now*/) override { return {}; }
  [[nodiscard]] ChannelStatistics statistics() const override { return {}; }
  std::vector<std::string> take() { return std::exchange(sent, {}); }

  std::vector<std::string> sent;
};

RobotSession some_session() {
  RobotSession session;
  session.robot = "robot";
  session.session = SessionNumber{1};
  session.stereo = {
      .focal_px = 450.0, .center_px = {1024.0, 1024.0}, .baseline_m = 0.1, .T_body_cam0 = {}};
  return session;
}

class SessionStreamsTest : public testing::Test {
 protected:
  void start() {
    streams_.start_session(some_session(), both_at(0).clock);
    streams_.use("a", Incarnation{1}, both_at(0));
  }

  RecordingChannel channel_;
  SessionStreams streams_{
      "robot",
      channel_,
      read_cloud_client_config(ConfigReader::from_string(default_config("robot")).section("client"))
          .stream};
};

TEST_F(SessionStreamsTest, SendNothingWithoutALocalizer) {
  streams_.start_session(some_session(), both_at(0).clock);
  streams_.add(submap_of(1));
  const SessionStreams::Sent sent = streams_.send_submaps(both_at(1));
  EXPECT_FALSE(sent.to_current || sent.to_successor);
  EXPECT_THAT(channel_.take(), IsEmpty());
}

TEST_F(SessionStreamsTest, TellTheOneThatIsLeftWhereTheSessionGoes) {
  start();
  streams_.use("b", Incarnation{1}, both_at(1));
  EXPECT_THAT(channel_.take(),
              ElementsAre("a: session to a", "b: session to b", "a: session to b"));
  streams_.use("b", Incarnation{2}, both_at(2));
  EXPECT_THAT(channel_.take(), ElementsAre("b: session to b")) << "a restart leaves nobody";
}

TEST_F(SessionStreamsTest, SendToTheSuccessorBesideTheLocalizerUntilItTakesOver) {
  start();
  streams_.begin_successor("b", Incarnation{1}, both_at(1));
  EXPECT_THAT(channel_.take(), ElementsAre("a: session to a", "b: session to b"));
  EXPECT_TRUE(streams_.is_successor("b"));
  EXPECT_EQ(streams_.of("b").localizer(), "b");
  EXPECT_EQ(streams_.of("a").localizer(), "a");
  streams_.add(submap_of(1));
  const SessionStreams::Sent sent = streams_.send_submaps(both_at(2));
  EXPECT_TRUE(sent.to_current && sent.to_successor);
  EXPECT_THAT(channel_.take(), ElementsAre("a: submap", "b: submap"));

  streams_.use("b", Incarnation{1}, both_at(3));
  EXPECT_THAT(channel_.take(), ElementsAre("a: session to b")) << "b has it already";
  EXPECT_EQ(streams_.current().localizer(), "b");
  EXPECT_EQ(streams_.current().uplink().sender().sent(), 1U) << "its stream goes on";
  EXPECT_FALSE(streams_.successor());
}

TEST_F(SessionStreamsTest, TellASuccessorThatItIsNotNeeded) {
  start();
  streams_.begin_successor("b", Incarnation{1}, both_at(1));
  channel_.take();
  streams_.begin_successor("c", Incarnation{1}, both_at(2));
  EXPECT_THAT(channel_.take(), ElementsAre("b: session to a", "c: session to c"));
  streams_.start_session(some_session(), both_at(3).clock);
  EXPECT_THAT(channel_.take(), ElementsAre("c: session to a"));
  streams_.use("a", Incarnation{1}, both_at(3));
  streams_.begin_successor("b", Incarnation{1}, both_at(4));
  channel_.take();
  streams_.end(both_at(5).clock);
  EXPECT_THAT(channel_.take(), ElementsAre("b: session to a"));
  EXPECT_EQ(streams_.current().localizer(), "");
}

TEST_F(SessionStreamsTest, UseNoNumberOfADroppedSuccessorAgain) {
  start();
  streams_.begin_successor("b", Incarnation{1}, both_at(1));
  const auto sent_to = [&](const std::string& localizer) {
    return streams_.of(localizer).uplink().sender().sent();
  };
  for (int tenths = 10; tenths < 200; ++tenths) {
    const double s = 0.1 * tenths;
    if (tenths <= 50 && tenths % 10 == 0) {
      streams_.add(submap_of(static_cast<std::uint32_t>(tenths / 10)));
    }
    if (!streams_.send_submaps(both_at(s)).to_current) continue;
    LocalizationResult acknowledging;
    acknowledging.session = SessionNumber{1};
    acknowledging.localizer = "a";
    acknowledging.incarnation = Incarnation{1};
    acknowledging.acknowledgements = {.base = SampleNumber{sent_to("a") - 1}, .bitmap = 1};
    streams_.answered(acknowledging, both_at(s).now);
  }
  const std::uint32_t used = sent_to("b");
  ASSERT_GT(used, sent_to("a")) << "which has acknowledged all";
  streams_.drop_successor(both_at(20).clock);
  streams_.begin_successor("b", Incarnation{1}, both_at(21));
  EXPECT_GE(sent_to("b"), used);
}

TEST_F(SessionStreamsTest, CountWhatCannotBeSent) {
  RobotSession session = some_session();
  session.start = MapOdomEstimate{};
  session.start->T_map_odom.p.x() = 1e30;
  streams_.start_session(session, both_at(0).clock);
  streams_.use("a", Incarnation{1}, both_at(0));
  streams_.begin_successor("b", Incarnation{1}, both_at(1));
  EXPECT_THAT(streams_.refusals(), Contains(std::pair(MessageRefusal::kNotEncodable, 1U)));
}

}  // namespace
}  // namespace fleetloc
