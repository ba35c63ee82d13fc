// Samples that no sane program sends, over real DDS, to ends that live.
#include <array>
#include <random>

#include <gtest/gtest.h>
#include <idl/statusPubSubTypes.h>

#include "test/transport/test_network.hpp"
#include "test/transport/wire_samples.hpp"

namespace fleetloc {
namespace {

constexpr int kTrials = 3000;

Bytes mutated(Bytes bytes, std::mt19937& random) {
  constexpr std::size_t kEncapsulation = 4;  // the channel itself refuses less
  if (random() % 4 == 0) bytes.resize(kEncapsulation + random() % (bytes.size() - kEncapsulation));
  for (std::uint32_t i = random() % 8; i < 8; ++i) {
    bytes[random() % bytes.size()] ^= static_cast<std::uint8_t>(1U << (random() % 8));
  }
  return bytes;
}

class DdsCorruption : public testing::Test {
 protected:
  bool submap_of_a_good_robot_arrives(std::uint32_t number) {
    return receives(
        cloud_,
        [&] { good_.send("cloud_1", numbered_submap(number, "good"), {}); },
        [&](const Message& message) {
          if (message.topic != Topic::kSubmap) return false;
          try {
            const auto submap = from_bytes<wire::SubmapPubSubType>(message.payload);
            return submap.robot().to_string() == "good" && submap.number() == number;
          } catch (const std::exception&) {  // one of the mutated
            return false;
          }
        });
  }

  const TestNetwork network_;
  DdsChannel cloud_{on_loopback(network_.domain(), ChannelRole::kCloud, "cloud_1")};
  DdsChannel good_{on_loopback(network_.domain(), ChannelRole::kRobot, "good")};
  DdsChannel mallory_{on_loopback(network_.domain(), ChannelRole::kRobot, "mallory")};
};

TEST_F(DdsCorruption, OfEveryTopicToALocalizerKeepsNoOtherRobotOut) {
  wire::RobotStatus status;
  status.robot("mallory");
  const std::array<Message, 3> valid{
      session_of("mallory"),
      numbered_submap(1, "mallory", 20),
      Message{.topic = Topic::kRobotStatus,
              .payload = to_bytes<wire::RobotStatusPubSubType>(status)}};
  ASSERT_TRUE(submap_of_a_good_robot_arrives(0));
  ASSERT_TRUE(matches(mallory_, Topic::kSubmap, "cloud_1"));
  std::mt19937 random(1);
  for (std::uint32_t trial = 1; trial <= kTrials; ++trial) {
    const Message& message = valid[random() % valid.size()];
    mallory_.send(message.topic == Topic::kSession ? "" : "cloud_1",
                  {message.topic, mutated(message.payload, random)},
                  {});
    if (trial % 300 == 0) {
      EXPECT_TRUE(submap_of_a_good_robot_arrives(trial)) << trial;
    }
  }
  EXPECT_GT(cloud_.diagnostics().undecodable, 0);
}

TEST_F(DdsCorruption, OfAnswersToARobotKeepsNoLaterAnswerOut) {
  std::mt19937 random(2);
  const Message valid = answer_to(1, wire::LOCALIZED);
  ASSERT_TRUE(matches(cloud_, Topic::kLocalization, "good"));
  for (int trial = 0; trial < kTrials; ++trial) {
    cloud_.send("good", {valid.topic, mutated(valid.payload, random)}, {});
  }
  EXPECT_TRUE(receives(
      good_,
      [&] { cloud_.send("good", valid, {}); },
      [&](const Message& message) { return message.payload == valid.payload; }));
}

}  // namespace
}  // namespace fleetloc
