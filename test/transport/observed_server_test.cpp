// A discovery server tells everyone only of what concerns him, but an observer of everything.
#include <algorithm>

#include <gtest/gtest.h>

#include "shared/transport/topic_observer.hpp"
#include "test/system/network_namespace.hpp"
#include "test/transport/discovery_server.hpp"
#include "test/transport/test_network.hpp"

namespace fleetloc {
namespace {

TEST(TopicObserver, IsToldOfEverythingByADiscoveryServer) {
  if (const auto reason = NetworkNamespace::why_impossible()) GTEST_SKIP() << *reason;
  if (const auto reason = DiscoveryServer::why_impossible()) GTEST_SKIP() << *reason;
  const TestNetwork network;
  NetworkNamespace computer;
  const auto inside = computer.enter();
  const DiscoveryServer server;
  const auto end = [&](ChannelRole role, const std::string& name) {
    auto config = on_loopback(network.domain(), role, name);
    config.participant_profile = "loopback_client";
    return config;
  };
  DdsChannel cloud(end(ChannelRole::kCloud, "cloud_1"));
  DdsChannel robot(end(ChannelRole::kRobot, "robot_1"));
  robot.prepare("cloud_1");
  TopicObserver observer(network.domain(), "loopback_client", "loopback");
  EXPECT_TRUE(comes_true([&] {
    const auto topics = observer.topics();
    const auto submaps =
        std::ranges::find(topics, "fleetloc/2/cloud_1/submap", &ObservedTopic::name);
    return submaps != topics.end() && submaps->writers == 1 && submaps->readers == 1;
  }));
}

}  // namespace
}  // namespace fleetloc
