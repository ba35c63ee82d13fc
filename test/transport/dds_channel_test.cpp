#include "shared/transport/dds_channel.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <limits>
#include <ranges>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

#include <gtest/gtest.h>

#include "shared/link/datagrams.hpp"
#include "test/transport/test_network.hpp"
#include "test/transport/wire_samples.hpp"

namespace fleetloc {
namespace {

auto with_number(std::uint32_t number) {
  return [number](const Message& message) {
    return message.topic == Topic::kSubmap && number_of(message) == number;
  };
}

class DdsChannelTest : public testing::Test {
 protected:
  void send(Message message) { robot_.send("cloud_1", std::move(message), {}); }

  const TestNetwork network_;
  DdsChannel robot_{on_loopback(network_.domain(), ChannelRole::kRobot, "robot_1")};
  DdsChannel cloud_{on_loopback(network_.domain(), ChannelRole::kCloud, "cloud_1")};
};

TEST_F(DdsChannelTest, CarriesSubmapsAndAnswers) {
  EXPECT_TRUE(receives(
      cloud_, [&] { send(numbered_submap(1)); }, with_number(1)));
  const Message answer = answer_to(1, wire::LOCALIZED);
  EXPECT_TRUE(receives(
      robot_,
      [&] { cloud_.send("robot_1", answer, {}); },
      [&](const Message& m) { return m.topic == answer.topic && m.payload == answer.payload; }));
}

TEST_F(DdsChannelTest, CarriesSubmapsThatNeedManyDatagrams) {
  const Message large = numbered_submap(1, "robot_1", 6000);
  ASSERT_EQ(datagram_sizes(large.payload.size()).size(), 10);
  EXPECT_TRUE(receives(
      cloud_,
      [&] { send(large); },
      [&](const Message& message) { return message.payload == large.payload; }));
}

TEST_F(DdsChannelTest, KeepsTheNewestMegabytesOfWhatNobodyTakes) {
  constexpr std::size_t kRows = 16'384;  // 32 KB
  constexpr std::size_t kMost = 16U << 20U;
  ASSERT_TRUE(matches(robot_, Topic::kSubmap, "cloud_1"));
  std::uint32_t number = 0;
  ASSERT_TRUE(comes_true([&] {
    for (int i = 0; i < 10; ++i) send(numbered_submap(++number, "robot_1", kRows));
    return cloud_.diagnostics().overflowed > 0;
  }));
  std::size_t bytes = 0;
  for (const Message& message : cloud_.receive({})) bytes += message.payload.size();
  EXPECT_LE(bytes, kMost);
  EXPECT_GT(bytes, kMost - 4 * kRows);
}

TEST_F(DdsChannelTest, CountsWhatCannotBeDecodedAndGoesOn) {
  const Message garbage{.topic = Topic::kSubmap, .payload = Bytes(40, 0xff)};
  EXPECT_TRUE(receives(
      cloud_,
      [&] {
        for (int i = 0; i < 10; ++i) send(garbage);
        send(numbered_submap(1));
      },
      [&](const Message& message) {
        EXPECT_NE(message.payload, garbage.payload);
        return with_number(1)(message) &&
               cloud_.diagnostics().undecodable.contains("encapsulation");
      }));
}

TEST_F(DdsChannelTest, HearsOnlyWhatIsSentToIt) {
  ASSERT_TRUE(receives(
      cloud_,
      [&] {
        robot_.send("cloud_2", numbered_submap(2), {});
        send(numbered_submap(1));
      },
      [](const Message& message) {
        EXPECT_NE(number_of(message), 2);
        return number_of(message) == 1;
      }));
  EXPECT_EQ(robot_.matched_readers(Topic::kSubmap, "cloud_2"), 0);
}

TEST_F(DdsChannelTest, WritesAgainToAReceiverThatWasReleased) {
  for (std::uint32_t number = 1; number < 4; ++number) {
    EXPECT_TRUE(receives(
        cloud_, [&] { send(numbered_submap(number)); }, with_number(number)));
    robot_.release("cloud_1");
  }
}

TEST_F(DdsChannelTest, RefusesAReceiverThatIsNobody) {
  EXPECT_THROW(robot_.send("cloud*", numbered_submap(1), {}), std::invalid_argument);
  EXPECT_THROW(robot_.send("", session_of("robot_1"), {}), std::invalid_argument);
  EXPECT_THROW(robot_.prepare("a/b"), std::invalid_argument);
}

// The first sample after a match arrives: nothing is lost to discovery.
TEST_F(DdsChannelTest, IsMatchedBeforeTheFirstMessageWithWhomItIsPreparedFor) {
  robot_.prepare("cloud_1");
  cloud_.prepare("robot_1");
  for (const Topic topic : {Topic::kSession, Topic::kCompactSubmap, Topic::kRobotStatus}) {
    EXPECT_TRUE(matches(robot_, topic, "cloud_1"));
  }
  EXPECT_TRUE(matches(cloud_, Topic::kLocalization, "robot_1"));
}

// The answer to an announcement comes within less than a millisecond. One that was lost would come
// again with the next announcement only.
TEST(DdsChannelStart, HearsAnAnswerHoweverSoonItComes) {
  const TestNetwork network;
  DdsChannel cloud{on_loopback(network.domain(), ChannelRole::kCloud, "cloud_1")};
  for (int i = 0; i < 20; ++i) {
    const std::string name = "robot_" + std::to_string(i);
    const auto began = std::chrono::steady_clock::now();
    DdsChannel robot{on_loopback(network.domain(), ChannelRole::kRobot, name)};
    robot.prepare("cloud_1");
    while (robot.matched_readers(Topic::kSession, "cloud_1") == 0) {
      ASSERT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(2)) << name;
      std::this_thread::yield();
    }
  }
}

TEST_F(DdsChannelTest, HearsMoreRobotsThanTheLibrarysDefaultOfTen) {
  for (std::uint32_t i = 0; i < 100; ++i) {
    const Message submap = numbered_submap(i, "robot_" + std::to_string(i));
    ASSERT_TRUE(receives(
        cloud_, [&] { send(submap); }, with_number(i)))
        << "robot " << i;
  }
  EXPECT_EQ(robot_.diagnostics().refused, 0);
}

TEST_F(DdsChannelTest, EndsWhileMessagesKeepArriving) {
  // A writer that never rests would keep its lock from discovery, and so the other side away.
  constexpr std::chrono::microseconds kBetween{200};
  const std::jthread traffic([&](const std::stop_token& stop) {
    for (std::uint32_t i = 0; !stop.stop_requested(); ++i) {
      robot_.send("cloud_2", numbered_submap(i), {});
      std::this_thread::sleep_for(kBetween);
    }
  });
  for (int round = 0; round < 5; ++round) {
    DdsChannel ending(on_loopback(network_.domain(), ChannelRole::kCloud, "cloud_2"));
    ASSERT_TRUE(ending.wait_for_message(kPatience));
  }
}

TEST_F(DdsChannelTest, CountsThePayloadAndTheHeadersOfEveryDatagram) {
  ASSERT_TRUE(receives(
      cloud_, [&] { send(numbered_submap(0)); }, with_number(0)));
  // What of these is still under way comes before this one.
  bool is_sent = false;
  ASSERT_TRUE(receives(
      cloud_,
      [&] {
        if (!std::exchange(is_sent, true)) send(numbered_submap(1));
      },
      with_number(1)));
  std::uint32_t number = 1;
  for (const std::size_t rows : {0U, 1U, 100U, 543U, 545U, 3000U, 6000U}) {
    const Message submap = numbered_submap(++number, "robot_1", rows);
    std::uint64_t expected = 0;
    for (const std::size_t bytes : datagram_sizes(submap.payload.size())) expected += bytes;
    // Now and then something else passes, too; hardly ever each time.
    std::uint64_t sent = std::numeric_limits<std::uint64_t>::max();
    std::uint64_t received = sent;
    for (int round = 0; round < 8; ++round) {
      const ChannelStatistics robot = robot_.statistics();
      const ChannelStatistics cloud = cloud_.statistics();
      send(submap);
      ASSERT_TRUE(cloud_.wait_for_message(kPatience));
      EXPECT_EQ(cloud_.receive({}).size(), 1);
      const auto payload = submap.payload.size();
      EXPECT_EQ(robot_.statistics().sent_payload_bytes - robot.sent_payload_bytes, payload);
      EXPECT_EQ(cloud_.statistics().received_payload_bytes - cloud.received_payload_bytes, payload);
      sent = std::min(sent, robot_.statistics().sent_wire_bytes - robot.sent_wire_bytes);
      received =
          std::min(received, cloud_.statistics().received_wire_bytes - cloud.received_wire_bytes);
    }
    EXPECT_EQ(sent, expected) << submap.payload.size() << " bytes of payload";
    EXPECT_EQ(received, expected) << submap.payload.size() << " bytes of payload";
  }
}

TEST_F(DdsChannelTest, EndsAWaitWhenItIsWoken) {
  constexpr std::chrono::hours kForEver{1};
  const std::jthread other([this] { cloud_.wake(); });
  EXPECT_FALSE(cloud_.wait_for_message(kForEver));
}

}  // namespace
}  // namespace fleetloc
