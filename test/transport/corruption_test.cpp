// Samples and datagrams that no sane program sends, over real DDS, to ends that live.
#include <algorithm>
#include <array>
#include <fstream>
#include <functional>
#include <random>

#include <gtest/gtest.h>
#include <idl/statusPubSubTypes.h>
#include <unistd.h>

#include "test/transport/intruder.hpp"
#include "test/transport/ros2_network.hpp"
#include "test/transport/rtps_messages.hpp"
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

/// Messages with some bytes changed, and announcements of somebody who is not there.
/// @param is_alive  is called after each 300 of them
void attack(const Intruder& intruder,
            std::uint32_t seed,
            const std::function<void(std::uint32_t)>& is_alive) {
  constexpr GuidPrefix kNobody{1, 15, 6, 6, 6};
  const Bytes announced = intruder.hear();
  ASSERT_GT(announced.size(), 100U);
  const Bytes of_nobody = with_prefix(announced, kNobody);
  std::mt19937 random(seed);
  for (std::uint32_t trial = 1; trial <= kTrials; ++trial) {
    intruder.send(random_message(random, kNobody));
    intruder.send(mutated(of_nobody, random));
    if (trial % 300 == 0) is_alive(trial);
  }
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
    mallory_.send("cloud_1", {message.topic, mutated(message.payload, random)}, {});
    if (trial % 300 == 0) {
      EXPECT_TRUE(submap_of_a_good_robot_arrives(trial)) << trial;
    }
  }
  EXPECT_FALSE(cloud_.diagnostics().undecodable.empty());
}

TEST_F(DdsCorruption, OfDatagramsEndsNoProgramAndKeepsNobodyOut) {
  ASSERT_TRUE(submap_of_a_good_robot_arrives(0));
  attack(Intruder(network_.domain(), 119), 4, [&](std::uint32_t trial) {
    EXPECT_TRUE(submap_of_a_good_robot_arrives(trial)) << trial;
  });
  EXPECT_FALSE(cloud_.diagnostics().malformed.empty());
  EXPECT_FALSE(good_.diagnostics().malformed.empty());
}

// A token of 33 million properties in an announcement (CVE-2024-30258): the library takes 2.4 GB
// for all of them before it reads the first.
TEST_F(DdsCorruption, OfLengthsWithinParametersTakesNoMemory) {
  ASSERT_TRUE(submap_of_a_good_robot_arrives(0));
  const Bytes announcement = ByteWriter()
                                 .u16(0)
                                 .u16(16)
                                 .entity(0)
                                 .entity(kParticipantWriter)
                                 .sequence_number(1)
                                 .bytes({0, 3, 0, 0})
                                 .u16(0x0050)
                                 .u16(16)
                                 .bytes({1, 15, 6, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0xc1})
                                 .u16(0x1001)
                                 .u16(16)
                                 .u32(2)
                                 .bytes({'a', 0, 0, 0})
                                 .u32(0x02000000)
                                 .u32(0)
                                 .u16(1)
                                 .u16(0)
                                 .written();
  Intruder(network_.domain(), 119)
      .send(message_of({submessage(0x15, 1 | 4, announcement)}, {1, 15, 6}));
  EXPECT_TRUE(comes_true([&] { return !cloud_.diagnostics().malformed.empty(); }));
  EXPECT_TRUE(submap_of_a_good_robot_arrives(1));
}

std::size_t resident_bytes() {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages >> pages;
  return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

// A datagram of 56 bytes tells of a million samples that there are not (CVE-2025-64438).
TEST_F(DdsCorruption, ByGapsWithoutEndFillsNoMemory) {
  ASSERT_TRUE(submap_of_a_good_robot_arrives(0));
  constexpr std::uint64_t kMillion = 1'000'000;
  constexpr std::uint64_t kGaps = 20;
  const std::size_t before = resident_bytes();
  const Intruder intruder(network_.domain(), 119);
  const GuidPrefix somebody = sender_of(intruder.hear());
  for (std::uint64_t i = 1; i <= kGaps; ++i) {
    intruder.send(message_of({gap(100 + kMillion * i, 50 + kMillion * (i + 1))}, somebody));
  }
  EXPECT_TRUE(submap_of_a_good_robot_arrives(1));
  const auto refused = [&] {
    return cloud_.diagnostics().malformed["too_many_gaps"] +
           good_.diagnostics().malformed["too_many_gaps"];
  };
  ASSERT_TRUE(comes_true([&] { return refused() >= kGaps - 1; }));
  // One million of numbers for each of the three ends; a third of the attack takes 1.3 GB.
  EXPECT_LT(resident_bytes() - before, 3 * 80 * kMillion);
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

// Whatever is sent to the ports where a robot listens for its drivers.
TEST(Ros2Corruption, OfDatagramsEndsNoRobotAndKeepsNoDriverOut) {
  const Ros2Network network;
  const Ros2Topic topic{"rt/imu", "sensor_msgs::msg::dds_::Imu_", Ros2Qos::kDefault};
  Ros2Participant driver(network.domain());
  Ros2Participant robot(network.domain());
  Ros2Reader reader(robot, {{topic, 10}});
  Ros2Writer writer = driver.create_writer(topic);
  ASSERT_TRUE(comes_true([&] { return writer.matched_readers() == 1; }));
  attack(Intruder(network.domain(), 31), 5, [&](std::uint32_t trial) {
    const Bytes sent{0, 1, 0, 0, static_cast<std::uint8_t>(trial / 300), 0, 0, 0};
    ASSERT_TRUE(writer.write(sent));
    const auto received = reader.take({}, kPatience);
    ASSERT_TRUE(received) << trial;
    EXPECT_EQ(received->payload, sent);
  });
  EXPECT_FALSE(robot.malformed().empty());
}

}  // namespace
}  // namespace fleetloc
