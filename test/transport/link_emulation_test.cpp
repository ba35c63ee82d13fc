#include <algorithm>
#include <chrono>

#include <gtest/gtest.h>

#include "shared/link/datagrams.hpp"
#include "test/transport/test_network.hpp"
#include "test/transport/wire_samples.hpp"

namespace fleetloc {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr milliseconds kDelay{250};
constexpr LinkDirection kDelayed{.delay_s = 0.25};
constexpr LinkDirection kLossy{.loss = 0.3};

/// A robot and a localizer, one of which emulates the robot's link.
struct Ends {
  Ends(std::uint32_t domain, const LinkConfig& link, ChannelRole emulating)
      : robot(on_loopback(domain,
                          ChannelRole::kRobot,
                          "robot_1",
                          emulating == ChannelRole::kRobot ? std::optional(link) : std::nullopt)),
        cloud(on_loopback(domain,
                          ChannelRole::kCloud,
                          "cloud_1",
                          emulating == ChannelRole::kCloud ? std::optional(link) : std::nullopt)) {}

  bool matched() {
    return matches(robot, Topic::kSubmap, "cloud_1") &&
           matches(cloud, Topic::kLocalization, "robot_1");
  }
  // The fastest of three, because others may keep the machine busy.
  Clock::duration uplink_time() {
    const auto once = [&] { return transit(robot, "cloud_1", numbered_submap(1), cloud); };
    return std::min({once(), once(), once()});
  }
  Clock::duration downlink_time() {
    const auto once = [&] {
      return transit(cloud, "robot_1", answer_to(1, wire::LOCALIZED), robot);
    };
    return std::min({once(), once(), once()});
  }

  DdsChannel robot, cloud;

 private:
  static Clock::duration transit(DdsChannel& from,
                                 const std::string& receiver,
                                 const Message& message,
                                 DdsChannel& to) {
    // A reader may know a writer a little later than the other way round.
    for (;;) {
      const auto start = Clock::now();
      from.send(receiver, message, {});
      if (!to.wait_for_message(std::chrono::seconds(2))) continue;
      static_cast<void>(to.receive({}));
      return Clock::now() - start;
    }
  }
};

class LinkEmulation : public testing::TestWithParam<ChannelRole> {
 protected:
  const TestNetwork network_;
};

TEST_P(LinkEmulation, DelaysTheUplinkOnly) {
  Ends ends(network_.domain(), {.uplink = kDelayed}, GetParam());
  ASSERT_TRUE(ends.matched());
  EXPECT_GE(ends.uplink_time(), kDelay);
  EXPECT_LT(ends.downlink_time(), kDelay);
}

TEST_P(LinkEmulation, DelaysTheDownlinkOnly) {
  Ends ends(network_.domain(), {.downlink = kDelayed}, GetParam());
  ASSERT_TRUE(ends.matched());
  EXPECT_LT(ends.uplink_time(), kDelay);
  EXPECT_GE(ends.downlink_time(), kDelay);
}

TEST_P(LinkEmulation, LosesTheShareThatItIsTold) {
  constexpr int kMessages = 150;
  Ends ends(network_.domain(), {.uplink = kLossy, .seed = 1}, GetParam());
  ASSERT_TRUE(ends.matched());
  ends.uplink_time();
  const auto before = ends.cloud.statistics().received_messages;
  for (std::uint32_t i = 0; i < kMessages; ++i) {
    ends.robot.send("cloud_1", numbered_submap(i), {});
    ends.cloud.wait_for_message(milliseconds(10));
    static_cast<void>(ends.cloud.receive({}));
  }
  const auto arrived = static_cast<double>(ends.cloud.statistics().received_messages - before);
  EXPECT_NEAR(arrived / kMessages, 1.0 - kLossy.loss, 0.15);
}

TEST_P(LinkEmulation, DeliversASessionInSpiteOfLoss) {
  Ends ends(network_.domain(), {.uplink = kLossy, .downlink = kLossy, .seed = 2}, GetParam());
  ends.robot.send("cloud_1", session_of("robot_1"), {});
  EXPECT_TRUE(ends.cloud.wait_for_message(kPatience));
}

TEST_P(LinkEmulation, CarriesBothCopiesOfADatagramAndDeliversItsSampleOnce) {
  constexpr std::uint32_t kMessages = 20;
  Ends ends(network_.domain(), {.uplink = {.duplication = 1.0}}, GetParam());
  ASSERT_TRUE(ends.matched());
  ends.uplink_time();
  const ChannelStatistics before = ends.cloud.statistics();
  std::size_t received = 0;
  for (std::uint32_t i = 0; i < kMessages; ++i) {
    ends.robot.send("cloud_1", numbered_submap(i), {});
    ASSERT_TRUE(ends.cloud.wait_for_message(kPatience));
    received += ends.cloud.receive({}).size();
  }
  EXPECT_EQ(received, kMessages);
  const ChannelStatistics after = ends.cloud.statistics();
  const std::size_t bytes = datagram_sizes(numbered_submap(0).payload.size()).front();
  EXPECT_GE(after.received_wire_bytes - before.received_wire_bytes, (2 * kMessages - 1) * bytes)
      << "the last copy may be on its way";
}

TEST_P(LinkEmulation, EndsWhileDatagramsAreOnTheirWay) {
  for (int round = 0; round < 2; ++round) {
    Ends ends(network_.domain(), {.uplink = kDelayed, .downlink = kDelayed}, GetParam());
    ASSERT_TRUE(ends.matched());
    for (std::uint32_t i = 0; i < 20; ++i) {
      ends.robot.send("cloud_1", numbered_submap(i), {});
      ends.cloud.send("robot_1", answer_to(i, wire::LOCALIZED), {});
    }
  }
}

INSTANTIATE_TEST_SUITE_P(,
                         LinkEmulation,
                         testing::Values(ChannelRole::kRobot, ChannelRole::kCloud),
                         [](const auto& role) {
                           return role.param == ChannelRole::kRobot ? "AtTheRobot" : "AtTheCloud";
                         });

}  // namespace
}  // namespace fleetloc
