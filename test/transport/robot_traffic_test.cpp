// What one robot sends and receives is its own business, however many others there are.
//
// Compared are the bytes of one exchange (a submap and a robot status up, an answer down), headers
// of RTPS, UDP and IP included. Discovery comes on top now and then, and does grow with the number
// of participants; in the least of many exchanges there is none.
#include <algorithm>
#include <iostream>
#include <limits>
#include <memory>
#include <vector>

#include <gtest/gtest.h>
#include <idl/statusPubSubTypes.h>

#include "shared/link/datagrams.hpp"
#include "shared/transport/monitoring/fleet_reader.hpp"
#include "shared/transport/monitoring/fleet_writer.hpp"
#include "shared/transport/monitoring/monitor_profiles.hpp"
#include "test/transport/test_network.hpp"
#include "test/transport/wire_samples.hpp"

namespace fleetloc {
namespace {

constexpr std::size_t kRows = 200;  // of the submaps: one datagram
constexpr std::uint32_t kExchanges = 25;
// Of discovery [bytes]: the localizer announces itself; those who watch would tell of themselves,
// at least 13,000 (seen with the fleet's ports).
constexpr std::uint64_t kAnnouncements = 6000;
constexpr std::chrono::seconds kAllHaveMet{10};  // discovery is over by then
constexpr std::chrono::seconds kLost{2};         // a sample that has not arrived by then

Message status_of(const std::string& robot) {
  wire::RobotStatus status;
  status.robot(robot);
  return {.topic = Topic::kRobotStatus, .payload = to_bytes<wire::RobotStatusPubSubType>(status)};
}

bool arrive(DdsChannel& channel, std::size_t messages) {
  const auto deadline = std::chrono::steady_clock::now() + kLost;
  std::size_t arrived = 0;
  while (arrived < messages && std::chrono::steady_clock::now() < deadline) {
    channel.wait_for_message(std::chrono::milliseconds(20));
    arrived += channel.receive({}).size();
  }
  return arrived >= messages;
}

struct Pair {
  std::string robot, localizer;
  DdsChannel& robot_end;
  DdsChannel& cloud_end;

  [[nodiscard]] bool exchange(std::uint32_t number) const {
    robot_end.send(localizer, numbered_submap(number, robot, kRows), {});
    robot_end.send(localizer, status_of(robot), {});
    if (!arrive(cloud_end, 2)) return false;
    cloud_end.send(robot, answer_to(number, wire::LOCALIZED), {});
    return arrive(robot_end, 1);
  }
  [[nodiscard]] bool is_matched() const {
    return matches(robot_end, Topic::kSubmap, localizer) &&
           matches(robot_end, Topic::kRobotStatus, localizer) &&
           matches(cloud_end, Topic::kLocalization, robot);
  }
};

struct ExchangeBytes {
  std::uint64_t sent = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t received = std::numeric_limits<std::uint64_t>::max();
};

/// Of the first pair, while each of the others makes an exchange of its own; of more exchanges than
/// kExchanges as long as discovery may go on and none was as small as `expected`.
ExchangeBytes min_bytes(const std::vector<Pair>& pairs, const ExchangeBytes& expected) {
  const auto deadline = std::chrono::steady_clock::now() + kAllHaveMet;
  const auto may_be_discovery = [&](const ExchangeBytes& bytes) {
    return (bytes.sent > expected.sent || bytes.received > expected.received) &&
           std::chrono::steady_clock::now() < deadline;
  };
  ExchangeBytes least;
  for (std::uint32_t number = 1; number <= kExchanges || may_be_discovery(least); ++number) {
    const ChannelStatistics before = pairs.front().robot_end.statistics();
    bool complete = true;
    for (const Pair& pair : pairs) complete = pair.exchange(number) && complete;
    if (!complete) continue;
    const ChannelStatistics after = pairs.front().robot_end.statistics();
    least.sent = std::min(least.sent, after.sent_wire_bytes - before.sent_wire_bytes);
    least.received =
        std::min(least.received, after.received_wire_bytes - before.received_wire_bytes);
  }
  return least;
}

ExchangeBytes exchange_on_the_wire() {
  const auto on_the_wire = [](const Message& message) -> std::uint64_t {
    return datagram_sizes(message.payload.size()).front();
  };
  return {
      .sent = on_the_wire(numbered_submap(1, "robot_1", kRows)) + on_the_wire(status_of("robot_1")),
      .received = on_the_wire(answer_to(1, wire::LOCALIZED))};
}

TEST(RobotTraffic, StaysTheSameWhenALocalizerNineRobotsAndAMonitorJoin) {
  const TestNetwork network;
  const auto join = [&](ChannelRole role, const std::string& name) {
    return std::make_unique<DdsChannel>(on_loopback(network.domain(), role, name));
  };
  const auto cloud_1 = join(ChannelRole::kCloud, "cloud_1");
  const auto robot_1 = join(ChannelRole::kRobot, "robot_1");
  std::vector<Pair> pairs{{"robot_1", "cloud_1", *robot_1, *cloud_1}};
  ASSERT_TRUE(pairs[0].is_matched());

  const ExchangeBytes expected = exchange_on_the_wire();
  const ExchangeBytes alone = min_bytes(pairs, expected);
  EXPECT_EQ(alone.sent, expected.sent);
  EXPECT_EQ(alone.received, expected.received);

  const auto cloud_2 = join(ChannelRole::kCloud, "cloud_2");
  std::vector<std::unique_ptr<DdsChannel>> robots;
  for (int i = 2; i <= 10; ++i) {
    const std::string name = "robot_" + std::to_string(i);
    robots.push_back(join(ChannelRole::kRobot, name));
    const bool is_first = i % 2 == 0;
    pairs.push_back(
        {name, is_first ? "cloud_1" : "cloud_2", *robots.back(), is_first ? *cloud_1 : *cloud_2});
    ASSERT_TRUE(pairs.back().is_matched()) << name;
  }
  Participant monitor(network.domain(), "loopback");
  const auto localizers = monitor.create_reader(topic_spec(Topic::kLocalizerStatus, ""));
  ASSERT_TRUE(
      comes_true([&] { return cloud_1->matched_readers(Topic::kLocalizerStatus, "") == 11; }));
  const ExchangeBytes among_others = min_bytes(pairs, expected);
  EXPECT_EQ(among_others.sent, expected.sent);
  EXPECT_EQ(among_others.received, expected.received);
}

TEST(RobotTraffic, IsTheSameHoweverManyWatchTheFleet) {
  const TestNetwork network;
  load_monitor_profiles();
  DdsChannel cloud(on_loopback(network.domain(), ChannelRole::kCloud, "cloud_1"));
  DdsChannel robot(on_loopback(network.domain(), ChannelRole::kRobot, "robot_1"));
  const std::vector<Pair> pair{{"robot_1", "cloud_1", robot, cloud}};
  ASSERT_TRUE(pair[0].is_matched());
  const ExchangeBytes expected = exchange_on_the_wire();
  const ExchangeBytes alone = min_bytes(pair, expected);  // once discovery is over
  EXPECT_EQ(alone.sent, expected.sent);
  FleetWriter monitored(network.domain());
  std::vector<std::unique_ptr<FleetReader>> monitors;
  for (const std::size_t watchers : {1U, 3U}) {
    const ChannelStatistics before = robot.statistics();
    while (monitors.size() < watchers) {
      monitors.push_back(std::make_unique<FleetReader>(network.domain()));
    }
    for (const auto& monitor : monitors) {
      ASSERT_TRUE(comes_true([&] {
        monitored.write({.localizer = "cloud_1"}, {{.localizer = "cloud_1", .robot = "robot_1"}});
        return !monitor->take().empty();
      }));
    }
    EXPECT_TRUE(monitored.is_watched());
    for (std::uint32_t number = 1; number <= kExchanges; ++number) {
      ASSERT_TRUE(pair[0].exchange(number));
    }
    const auto more_down = robot.statistics().received_wire_bytes - before.received_wire_bytes -
                           kExchanges * expected.received;
    std::cout << watchers << " watch: " << more_down << " bytes down beside the exchanges\n";
    EXPECT_LT(more_down, kAnnouncements) << watchers << " watch";
  }
}

}  // namespace
}  // namespace fleetloc
