// fleetloc-topic beside a robot's end and a localizer's end of the network.
#include <chrono>
#include <csignal>
#include <future>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "shared/compact/submap_sample.hpp"
#include "shared/transport/dds_channel.hpp"
#include "shared/transport/qos_profiles.hpp"
#include "shared/wire/session_codec.hpp"
#include "test/system/loopback_network.hpp"
#include "test/unit/compact/moving_robot.hpp"

namespace fleetloc {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using Words = std::vector<std::string>;

/// A robot that sends one and the same submap to a localizer, ten times a second.
class TopicTest : public testing::Test {
 protected:
  TopicTest() {
    robot_.emplace(end(ChannelRole::kRobot, "robot", "robot_1"));
    cloud_.emplace(end(ChannelRole::kCloud, "cloud", "cloud_1"));
    RobotSession session;
    session.robot = submap_.robot;
    session.session = submap_.session;
    session.localizer = "cloud_1";
    session.encoding = SubmapEncoding::kCompact;
    session.stereo = some_stereo();
    robot_->send("cloud_1", {Topic::kSession, encode(session)}, {});
  }

  [[nodiscard]] DdsChannel::Config end(ChannelRole role,
                                       const std::string& profile,
                                       const std::string& name) const {
    return {.domain = static_cast<std::uint32_t>(std::stoi(network().domain())),
            .participant_profile = profile,
            .role = role,
            .name = name,
            .link = {}};
  }

  void send() {
    const Bytes sample = encode_compact(submap_, {}, {}, some_stereo());
    robot_->send("cloud_1", {Topic::kCompactSubmap, sample}, {});
    static_cast<void>(cloud_->receive({}));
  }

  /// The program's outcome, while the robot sends.
  Outcome outcome_of(Words words) {
    words.insert(words.end(), {"--qos", network().qos(), "--domain", network().domain()});
    ChildProgram program(FLEETLOC_TOPIC, words);
    auto ended = std::async(std::launch::async, [&] { return program.wait(); });
    while (ended.wait_for(std::chrono::milliseconds(100)) != std::future_status::ready) send();
    return ended.get();
  }

  static const LoopbackNetwork& network() {
    static const LoopbackNetwork network;
    return network;
  }
  static void SetUpTestSuite() { load_qos_profiles(network().qos()); }

  Submap submap_ = moving_robot(100, 3);
  std::optional<DdsChannel> robot_, cloud_;
};

TEST_F(TopicTest, EchoShowsADecodedSubmapAsJson) {
  const Outcome echo = outcome_of({"echo", "cloud_1/submap", "--json", "--count", "40"});
  EXPECT_EQ(echo.exit_code, 0) << echo.errors;
  std::istringstream lines(echo.output);
  std::string line;
  nlohmann::json last;
  int count = 0;
  for (; std::getline(lines, line); ++count) last = nlohmann::json::parse(line);
  EXPECT_EQ(count, 40);
  EXPECT_EQ(last["topic"], "fleetloc/2/cloud_1/submap");
  EXPECT_EQ(last["robot"], "robot_1");
  EXPECT_EQ(last["number"], 40);
  ASSERT_TRUE(last.contains("keyframes")) << "the session is reliable, and came before";
  EXPECT_EQ(last["keyframes"].size(), 3);
  EXPECT_EQ(last["keyframes"][2]["observations"].size(), submap_.keyframes[2].observations.size());
  EXPECT_EQ(last["edges"].size(), 2);
}

TEST_F(TopicTest, EchoShowsASessionAsText) {
  const Outcome echo = outcome_of({"echo", "session", "--count", "1"});
  EXPECT_EQ(echo.exit_code, 0) << echo.errors;
  EXPECT_THAT(echo.output,
              AllOf(testing::StartsWith("---\ntopic: fleetloc/2/cloud_1/session\n"),
                    HasSubstr("robot: robot_1\n"),
                    HasSubstr("  baseline_m: 0.11\n")));
}

TEST_F(TopicTest, ListShowsTypesEndpointsAndRates) {
  const Outcome list = outcome_of({"list", "--duration", "6"});
  EXPECT_EQ(list.exit_code, 0) << list.errors;
  std::istringstream lines(list.output);
  std::string name, type, writers, readers, rate, bytes;
  std::string line;
  while (name != "fleetloc/2/cloud_1/submap" && std::getline(lines, line)) {
    std::istringstream(line) >> name >> type >> writers >> readers >> rate >> bytes;
  }
  ASSERT_EQ(name, "fleetloc/2/cloud_1/submap") << list.output;
  EXPECT_EQ(type, "fleetloc::wire::CompactSubmap");
  EXPECT_EQ(writers, "1");
  EXPECT_EQ(readers, "1") << "itself is not counted";
  EXPECT_GT(std::stod(rate), 2.0);
  EXPECT_GT(std::stod(bytes), 1000.0);
}

TEST_F(TopicTest, EndsCleanlyWhenItIsInterrupted) {
  ChildProgram program(FLEETLOC_TOPIC,
                       {"echo", "--qos", network().qos(), "--domain", network().domain()});
  auto ended = std::async(std::launch::async, [&] { return program.wait(); });
  while (ended.wait_for(std::chrono::milliseconds(100)) != std::future_status::ready) {
    program.signal(SIGTERM);
  }
  const Outcome outcome = ended.get();
  EXPECT_EQ(outcome.errors, "");
}

}  // namespace
}  // namespace fleetloc
