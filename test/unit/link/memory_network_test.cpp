#include "shared/link/memory_network.hpp"

#include <algorithm>
#include <memory>
#include <set>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "shared/link/datagrams.hpp"

namespace fleetloc {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr Timestamp kBegin{seconds(100)};

Message message(Topic topic, std::uint8_t content, std::size_t size = 100) {
  return {.topic = topic, .payload = Bytes(size, content)};
}

std::vector<int> contents(const std::vector<Message>& messages) {
  std::vector<int> contents;
  contents.reserve(messages.size());
  for (const Message& message : messages) contents.push_back(message.payload.front());
  return contents;
}

LinkConfig uplink(const LinkDirection& direction, std::uint64_t seed = 1) {
  return {.uplink = direction, .downlink = {}, .seed = seed};
}

/// A network with one robot and one localizer.
struct OneOfEach {
  explicit OneOfEach(const LinkConfig& config) : network(config) {}

  MemoryNetwork network;
  std::unique_ptr<Channel> robot = network.join_robot("robot");
  std::unique_ptr<Channel> cloud = network.join_cloud("cloud");
};

TEST(DatagramSizes, SplitWhatDoesNotFitBelowTheMtu) {
  EXPECT_EQ(datagram_sizes(100).size(), 1);
  const auto sizes = datagram_sizes(12'000);
  EXPECT_EQ(sizes.size(), 10);
  EXPECT_LE(std::ranges::max(sizes), 1400);
}

TEST(MemoryNetwork, CarriesEveryTopicToThoseWhoHearIt) {
  MemoryNetwork network(perfect_link());
  const auto robot = network.join_robot("robot");
  const auto other_robot = network.join_robot("other_robot");
  const auto cloud = network.join_cloud("cloud");
  const auto other_cloud = network.join_cloud("other_cloud");
  robot->send("cloud", message(Topic::kSession, 1), kBegin);
  robot->send("cloud", message(Topic::kSubmap, 2), kBegin);
  robot->send("cloud", message(Topic::kRobotStatus, 3), kBegin);
  cloud->send("robot", message(Topic::kLocalization, 4), kBegin);
  cloud->send("", message(Topic::kLocalizerStatus, 5), kBegin);
  cloud->send("robot", message(Topic::kLocalization, 6), kBegin);
  EXPECT_THAT(contents(cloud->receive(kBegin)), ElementsAre(1, 2, 3));
  EXPECT_THAT(other_cloud->receive(kBegin), IsEmpty());
  EXPECT_THAT(contents(robot->receive(kBegin)), ElementsAre(4, 5, 6));
  EXPECT_THAT(contents(other_robot->receive(kBegin)), ElementsAre(5));
  EXPECT_THAT(cloud->receive(kBegin + seconds(10)), IsEmpty()) << "each message is returned once";
}

TEST(MemoryNetwork, DelaysEachDirectionOnItsOwn) {
  const auto [network, robot, cloud] =
      OneOfEach({.uplink = {.delay_s = 1.0}, .downlink = {.delay_s = 0.1}, .seed = 1});
  robot->send("cloud", message(Topic::kSubmap, 1), kBegin);
  cloud->send("robot", message(Topic::kLocalization, 2), kBegin);
  EXPECT_THAT(robot->receive(kBegin + milliseconds(99)), IsEmpty());
  EXPECT_THAT(contents(robot->receive(kBegin + milliseconds(100))), ElementsAre(2));
  EXPECT_THAT(cloud->receive(kBegin + milliseconds(999)), IsEmpty());
  EXPECT_THAT(contents(cloud->receive(kBegin + milliseconds(1000))), ElementsAre(1));
}

TEST(MemoryNetwork, GivesMessagesInOrderOfArrival) {
  MemoryNetwork network(uplink({.delay_s = 1.0}));
  const auto first = network.join_robot("first");
  const auto second = network.join_robot("second");
  const auto cloud = network.join_cloud("cloud");
  first->send("cloud", message(Topic::kSubmap, 1), kBegin + milliseconds(20));
  second->send("cloud", message(Topic::kSubmap, 2), kBegin + milliseconds(10));
  first->send("cloud", message(Topic::kSubmap, 3), kBegin + milliseconds(20));
  EXPECT_THAT(contents(cloud->receive(kBegin + seconds(2))), ElementsAre(2, 1, 3));
}

TEST(MemoryNetwork, CountsPayloadAndWireBytes) {
  MemoryNetwork network(perfect_link());
  const auto robot = network.join_robot("robot");
  robot->send("cloud", message(Topic::kSubmap, 1), kBegin);  // nobody hears it
  EXPECT_EQ(robot->statistics().sent_messages, 1);
  EXPECT_EQ(robot->statistics().sent_wire_bytes, 0);
  const auto cloud = network.join_cloud("cloud");
  robot->send("cloud", message(Topic::kSubmap, 1, 3000), kBegin);
  EXPECT_THAT(cloud->receive(kBegin), testing::SizeIs(1));
  std::size_t wire_bytes = 0;
  for (const std::size_t bytes : datagram_sizes(3000)) wire_bytes += bytes;
  EXPECT_EQ(robot->statistics().sent_payload_bytes, 3100);
  EXPECT_EQ(robot->statistics().sent_wire_bytes, wire_bytes);
  EXPECT_EQ(cloud->statistics().received_messages, 1);
  EXPECT_EQ(cloud->statistics().received_payload_bytes, 3000);
  EXPECT_EQ(cloud->statistics().received_wire_bytes, wire_bytes);
}

TEST(MemoryNetwork, LosesASampleWithAnyOfItsFragments) {
  constexpr int kSamples = 4000;
  const auto [network, robot, cloud] = OneOfEach(uplink({.loss = 0.5}));
  const std::size_t size = 4000;
  ASSERT_EQ(datagram_sizes(size).size(), 4);
  for (int i = 0; i < kSamples; ++i) robot->send("cloud", message(Topic::kSubmap, 1, size), kBegin);
  const auto arrived = static_cast<double>(cloud->receive(kBegin).size());
  EXPECT_NEAR(arrived / kSamples, 1.0 / 16, 0.015);
  const ChannelStatistics sent = robot->statistics();
  const ChannelStatistics received = cloud->statistics();
  EXPECT_NEAR(static_cast<double>(received.received_wire_bytes),
              0.5 * static_cast<double>(sent.sent_wire_bytes),
              0.02 * static_cast<double>(sent.sent_wire_bytes))
      << "fragments that arrive are received, whatever becomes of their sample";
}

TEST(MemoryNetwork, RepeatsASessionUntilItArrivesAndThenNoMore) {
  const auto [network, robot, cloud] = OneOfEach(uplink({.loss = 0.9, .delay_s = 0.5}, 3));
  robot->send("cloud", message(Topic::kSession, 1), kBegin);
  int arrived = 0;
  for (int second = 0; second < 600; ++second) {
    arrived += static_cast<int>(cloud->receive(kBegin + seconds(second)).size());
  }
  EXPECT_EQ(arrived, 1);
}

TEST(MemoryNetwork, RepeatsOnlyTheLastSession) {
  MemoryNetwork network(uplink({.loss = 1.0}));
  const auto robot = network.join_robot("robot");
  robot->send("cloud", message(Topic::kSession, 1), kBegin);
  robot->send("cloud", message(Topic::kSession, 2), kBegin);
  const auto cloud = network.join_cloud("cloud");
  EXPECT_THAT(cloud->receive(kBegin + seconds(60)), IsEmpty());
  const std::uint64_t one = datagram_sizes(100).front();
  EXPECT_EQ(robot->statistics().sent_wire_bytes, 61 * one) << "once a second, one sample";
}

TEST(MemoryNetwork, TellsALateJoinerTheLastSessionOfEveryRobotThatIsThere) {
  MemoryNetwork network(uplink({.delay_s = 0.5}));
  const auto robot = network.join_robot("robot");
  const auto other_robot = network.join_robot("other_robot");
  robot->send("cloud", message(Topic::kSession, 1), kBegin);
  robot->send("cloud", message(Topic::kSession, 2), kBegin);
  robot->send("cloud", message(Topic::kSubmap, 3), kBegin);
  other_robot->send("cloud", message(Topic::kSession, 4), kBegin);
  {
    const auto leaving = network.join_robot("leaving_robot");
    leaving->send("cloud", message(Topic::kSession, 5), kBegin);
  }
  EXPECT_THAT(robot->receive(kBegin + seconds(7)), IsEmpty());
  const auto cloud = network.join_cloud("cloud");
  EXPECT_THAT(cloud->receive(kBegin + milliseconds(7499)), IsEmpty());
  EXPECT_THAT(contents(cloud->receive(kBegin + milliseconds(7500))), ElementsAre(2, 4));
}

TEST(MemoryNetwork, DropsWhatArrivesBehindANewerSampleOfTheSameSenderAndTopic) {
  constexpr int kSamples = 200;
  const auto [network, robot, cloud] = OneOfEach(uplink({.jitter_s = 0.1}));
  for (int i = 0; i < kSamples; ++i) {
    robot->send("cloud",
                message(Topic::kSubmap, static_cast<std::uint8_t>(i)),
                kBegin + milliseconds(10 * i));
  }
  const auto heard = contents(cloud->receive(kBegin + seconds(60)));
  EXPECT_TRUE(std::ranges::is_sorted(heard));
  EXPECT_GT(heard.size(), kSamples / 10);
  EXPECT_LT(heard.size(), kSamples / 2);
  const ChannelStatistics received = cloud->statistics();
  EXPECT_EQ(received.received_messages, heard.size());
  EXPECT_EQ(received.received_wire_bytes, kSamples * datagram_sizes(100).front()) << "all arrive";
}

TEST(MemoryNetwork, DropsNothingBehindASampleOfAnotherSenderOrTopic) {
  MemoryNetwork network(uplink({.jitter_s = 0.1}));
  const auto cloud = network.join_cloud("cloud");
  std::vector<std::unique_ptr<Channel>> robots;
  for (int i = 0; i < 100; ++i) {
    robots.push_back(network.join_robot("robot_" + std::to_string(i)));
    const auto content = static_cast<std::uint8_t>(i);
    robots.back()->send("cloud", message(Topic::kSubmap, content), kBegin);
    robots.back()->send("cloud", message(Topic::kRobotStatus, content), kBegin);
  }
  EXPECT_THAT(cloud->receive(kBegin + seconds(60)), testing::SizeIs(200));
}

TEST(MemoryNetwork, DropsDuplicatesAndCountsTheirBytes) {
  const auto [network, robot, cloud] = OneOfEach(uplink({.delay_s = 0.1, .duplication = 1.0}));
  robot->send("cloud", message(Topic::kSession, 1), kBegin);
  robot->send("cloud", message(Topic::kSubmap, 2), kBegin);
  robot->send("cloud", message(Topic::kSubmap, 3, 4000), kBegin);
  EXPECT_THAT(contents(cloud->receive(kBegin + seconds(60))), ElementsAre(1, 2, 3));
  EXPECT_EQ(cloud->statistics().received_wire_bytes, 2 * robot->statistics().sent_wire_bytes);
}

TEST(MemoryNetwork, CarriesAnotherFragmentInTheRepetitionOfAStatus) {
  const auto [network, robot, cloud] =
      OneOfEach({.uplink = {}, .downlink = {.loss = 0.8}, .seed = 2});
  cloud->send("", message(Topic::kLocalizerStatus, 1, 4000), kBegin);
  EXPECT_THAT(contents(robot->receive(kBegin + seconds(60))), ElementsAre(1));
}

TEST(MemoryNetwork, HasItsOutagesInBothDirectionsAtTheSameTime) {
  const LinkDirection out{.outages = {.at = {{.from_s = 10.0, .for_s = 5.0}}}};
  const auto [network, robot, cloud] = OneOfEach({.uplink = out, .downlink = out, .seed = 1});
  std::vector<int> up;
  std::vector<int> down;
  for (int second = 0; second < 20; ++second) {
    const auto content = static_cast<std::uint8_t>(second);
    const Timestamp now = kBegin + seconds(second);
    robot->send("cloud", message(Topic::kSubmap, content), now);
    if (second > 7) cloud->send("robot", message(Topic::kLocalization, content), now);
    for (const int heard : contents(cloud->receive(now))) up.push_back(heard);
    for (const int heard : contents(robot->receive(now))) down.push_back(heard);
  }
  EXPECT_THAT(up, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 15, 16, 17, 18, 19));
  EXPECT_THAT(down, ElementsAre(8, 9, 15, 16, 17, 18, 19));
}

TEST(MemoryNetwork, DeliversWhatIsOnItsWayFromASenderThatHasLeft) {
  MemoryNetwork network(uplink({.delay_s = 1.0, .duplication = 1.0}));
  const auto cloud = network.join_cloud("cloud");
  network.join_robot("robot")->send("cloud", message(Topic::kSubmap, 1), kBegin);
  EXPECT_THAT(contents(cloud->receive(kBegin + seconds(2))), ElementsAre(1));
}

TEST(MemoryNetwork, RepeatsToEachReceiverTheLastOneThatWasMeantForIt) {
  MemoryNetwork network(uplink({.delay_s = 0.5}));
  const auto robot = network.join_robot("robot");
  for (const int content : {1, 2}) {
    const auto session = [&](int more) {
      return message(Topic::kSession, static_cast<std::uint8_t>(content + more));
    };
    robot->send("new", session(0), kBegin);
    robot->send("old", session(2), kBegin);
    robot->send("released", session(4), kBegin);
  }
  robot->release("released");
  const auto newer = network.join_cloud("new");
  const auto older = network.join_cloud("old");
  const auto released = network.join_cloud("released");
  EXPECT_THAT(contents(newer->receive(kBegin + seconds(9))), ElementsAre(2));
  EXPECT_THAT(contents(older->receive(kBegin + seconds(9))), ElementsAre(4));
  EXPECT_THAT(released->receive(kBegin + seconds(9)), IsEmpty());
}

TEST(MemoryNetwork, RepeatsBitByBit) {
  const auto run = [] {
    const auto [network, robot, cloud] =
        OneOfEach({.uplink = {.loss = 0.3, .delay_s = 0.2, .jitter_s = 0.1},
                   .downlink = {.loss = 0.5, .delay_s = 0.1, .duplication = 0.1},
                   .seed = 11});
    robot->send("cloud", message(Topic::kSession, 0), kBegin);
    std::vector<int> heard;
    for (int i = 0; i < 200; ++i) {
      const Timestamp now = kBegin + milliseconds(100 * i);
      robot->send("cloud", message(Topic::kSubmap, static_cast<std::uint8_t>(i)), now);
      for (const int content : contents(cloud->receive(now))) {
        heard.push_back(content);
        cloud->send("robot", message(Topic::kLocalization, 1), now);
      }
      heard.push_back(-static_cast<int>(robot->receive(now).size()));
    }
    return heard;
  };
  EXPECT_EQ(run(), run());
}

TEST(MemoryNetwork, GivesEveryRobotALinkOfItsOwnWhoeverJoinsFirst) {
  const auto heard_from_b = [](bool a_first) {
    MemoryNetwork network(uplink({.loss = 0.5}));
    std::set<std::unique_ptr<Channel>> others;
    if (a_first) others.insert(network.join_robot("a"));
    const auto b = network.join_robot("b");
    const auto cloud = network.join_cloud("cloud");
    for (int i = 0; i < 100; ++i) {
      for (const auto& other : others) other->send("cloud", message(Topic::kSubmap, 200), kBegin);
      b->send("cloud", message(Topic::kSubmap, static_cast<std::uint8_t>(i)), kBegin);
    }
    auto heard = contents(cloud->receive(kBegin));
    std::erase(heard, 200);
    return heard;
  };
  EXPECT_EQ(heard_from_b(false), heard_from_b(true));
}

}  // namespace
}  // namespace fleetloc
