// A localizer's computer is often in several networks, of which a robot reaches one.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "shared/transport/workarounds/network_addresses.hpp"
#include "shared/transport/workarounds/route_cache.hpp"
#include "test/system/network_namespace.hpp"
#include "test/transport/test_network.hpp"
#include "test/transport/wire_samples.hpp"

namespace fleetloc {
namespace {

class ReachableAddress : public testing::Test {
 protected:
  void SetUp() override {
    if (const auto reason = NetworkNamespace::why_impossible()) GTEST_SKIP() << *reason;
    robots_.emplace();
    clouds_.emplace();
    network_.emplace(true);
    network_->plug_in(*robots_, "10.77.0.1");
    network_->plug_in(*clouds_, "10.77.0.2");
  }

  [[nodiscard]] std::unique_ptr<DdsChannel> channel(ChannelRole role, const std::string& name) {
    auto config = on_loopback(domain_.domain(), role, name);
    config.participant_profile = "everywhere";
    const auto inside = (role == ChannelRole::kRobot ? *robots_ : *clouds_).enter();
    return std::make_unique<DdsChannel>(config);
  }

  const TestNetwork domain_;

  std::optional<NetworkNamespace> robots_, clouds_;
  std::optional<SwitchedNetwork> network_;
};

TEST_F(ReachableAddress, HasARoute) {
  robots_->ip("route delete default");
  const auto inside = robots_->enter();
  EXPECT_TRUE(has_route(0x0a4d0002));   // 10.77.0.2
  EXPECT_TRUE(has_route(0x7f000001));   // 127.0.0.1
  EXPECT_FALSE(has_route(0x0a4e0002));  // 10.78.0.2
}

TEST_F(ReachableAddress, IsRememberedUntilItsRouteChangesForASecond) {
  constexpr std::uint32_t kFar = 0x0a4e0002;  // 10.78.0.2
  robots_->ip("route delete default");
  const auto inside = robots_->enter();
  RouteCache routes;
  RouteCache::Clock::time_point now{};
  EXPECT_FALSE(routes.has_route(kFar, now));
  robots_->ip("route add 10.78.0.0/24 dev eth0");
  now += std::chrono::seconds(1);
  EXPECT_TRUE(routes.has_route(kFar, now));
  robots_->ip("route delete 10.78.0.0/24");
  EXPECT_TRUE(routes.has_route(kFar, now)) << "not asked again so soon";
  now += std::chrono::seconds(1);
  EXPECT_FALSE(routes.has_route(kFar, now));
}

TEST_F(ReachableAddress, OfAParticipantThatIsHeardIsUsedAlone) {
  constexpr std::size_t kRows = 400;
  clouds_->ip("address add 172.17.0.1/16 dev eth0");  // which a robot's router would know, too
  const auto cloud = channel(ChannelRole::kCloud, "cloud_1");
  const auto robot = channel(ChannelRole::kRobot, "robot_1");
  ASSERT_TRUE(matches(*robot, Topic::kSubmap, "cloud_1"));
  const Message submap = numbered_submap(1, "robot_1", kRows);
  std::uint64_t least = std::numeric_limits<std::uint64_t>::max();  // without discovery's
  for (int i = 0; i < 10; ++i) {
    const std::uint64_t before = robot->statistics().sent_wire_bytes;
    ASSERT_TRUE(receives(
        *cloud,
        [&] {
          if (cloud->statistics().received_messages == static_cast<std::uint64_t>(i)) {
            robot->send("cloud_1", submap, {});
          }
        },
        [](const Message& message) { return message.topic == Topic::kSubmap; }));
    ASSERT_TRUE(receives(
        *robot,
        [&] { cloud->send("robot_1", answer_to(1, wire::LOCALIZED), {}); },
        [](const Message& message) { return message.topic == Topic::kLocalization; }));
    least = std::min(least, robot->statistics().sent_wire_bytes - before);
  }
  EXPECT_GT(least, submap.payload.size());
  EXPECT_LT(least, 3 * submap.payload.size() / 2);
}

}  // namespace
}  // namespace fleetloc
