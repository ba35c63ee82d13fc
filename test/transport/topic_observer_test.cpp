#include "shared/transport/topic_observer.hpp"

#include <algorithm>
#include <optional>

#include <gtest/gtest.h>

#include "test/transport/test_network.hpp"
#include "test/transport/wire_samples.hpp"

namespace fleetloc {
namespace {

std::optional<ObservedTopic> find(const TopicObserver& observer, const std::string& name) {
  const auto topics = observer.topics();
  const auto found = std::ranges::find(topics, name, &ObservedTopic::name);
  return found != topics.end() ? std::optional(*found) : std::nullopt;
}

TEST(TopicObserver, CountsWritersAndReadersOfOthersAndSeesThemGo) {
  const TestNetwork network;
  const std::string name = "fleetloc/2/cloud_1/full_submap";
  TopicObserver observer(network.domain(), "loopback", "loopback");
  DdsChannel cloud(on_loopback(network.domain(), ChannelRole::kCloud, "cloud_1"));
  {
    DdsChannel robot(on_loopback(network.domain(), ChannelRole::kRobot, "robot_1"));
    robot.matched_readers(Topic::kSubmap, "cloud_1");  // creates the writer
    ASSERT_TRUE(comes_true([&] {
      const auto topic = find(observer, name);
      return topic && topic->writers == 1 && topic->readers == 1;
    }));
    EXPECT_EQ(find(observer, name)->type, "fleetloc::wire::Submap");
    EXPECT_TRUE(observer.read(name));
    EXPECT_EQ(find(observer, name)->readers, 1) << "itself is not counted";
  }
  EXPECT_TRUE(comes_true([&] {
    const auto topic = find(observer, name);
    return topic && topic->writers == 0 && topic->readers == 1;
  }));
}

TEST(TopicObserver, GetsTheSamplesThatTheReceiverGets) {
  const TestNetwork network;
  const std::string submaps = "fleetloc/2/cloud_1/full_submap";
  const std::string sessions = "fleetloc/2/cloud_1/session";
  DdsChannel cloud(on_loopback(network.domain(), ChannelRole::kCloud, "cloud_1"));
  DdsChannel robot(on_loopback(network.domain(), ChannelRole::kRobot, "robot_1"));
  robot.send("cloud_1", session_of("robot_1"), {});
  TopicObserver observer(network.domain(), "loopback", "loopback");
  EXPECT_TRUE(observer.read(submaps));
  EXPECT_TRUE(observer.read(sessions));
  EXPECT_FALSE(observer.read("rt/imu")) << "is not of fleetloc";
  bool has_submap = false;
  bool has_session = false;
  const Message submap = numbered_submap(7);
  EXPECT_TRUE(receives(
      cloud,
      [&] {
        robot.send("cloud_1", submap, {});
        for (const ObservedSample& sample : observer.take()) {
          has_submap |= sample.topic == submaps && sample.payload == submap.payload;
          has_session |=
              sample.topic == sessions && sample.payload == session_of("robot_1").payload;
        }
      },
      [&](const Message&) { return has_submap && has_session; }));
}

TEST(TopicObserver, KnowsTopicsByTheirNames) {
  for (const Topic topic : {Topic::kSession,
                            Topic::kSubmap,
                            Topic::kCompactSubmap,
                            Topic::kLocalization,
                            Topic::kRobotStatus}) {
    EXPECT_EQ(topic_of(topic_spec(topic, "alpha").name), std::pair(topic, std::string("alpha")));
  }
  EXPECT_EQ(topic_of("fleetloc/2/localizers"), std::pair(Topic::kLocalizerStatus, std::string()));
  for (const char* name :
       {"fleetloc/1/localizers", "fleetloc/2/alpha/nothing", "fleetloc/2/", ""}) {
    EXPECT_FALSE(topic_of(name)) << name;
  }
}

}  // namespace
}  // namespace fleetloc
