// Robots and localizers find each other where much is lost, or everything for a while.
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "test/system/child_program.hpp"
#include "test/system/network_namespace.hpp"
#include "test/transport/test_network.hpp"
#include "test/transport/wire_samples.hpp"

namespace fleetloc {
namespace {

using Clock = std::chrono::steady_clock;

/// Two computers in one network, with the profiles as they ship.
class LossyDiscovery : public testing::Test {
 protected:
  void SetUp() override {
    if (const auto reason = NetworkNamespace::why_impossible()) GTEST_SKIP() << *reason;
    robots_.emplace();
    clouds_.emplace();
    network_.emplace(true);
    network_->plug_in(*robots_, "10.77.0.1");
    network_->plug_in(*clouds_, "10.77.0.2");
    const auto inside = clouds_->enter();
    const std::string domain = std::to_string(domain_.domain());
    cloud_ =
        std::make_unique<ChildProgram>(TRANSPORT_PEER, std::vector<std::string>{domain, "cloud"});
  }

  [[nodiscard]] std::unique_ptr<DdsChannel> robot(const std::string& name, const LinkConfig& link) {
    const auto inside = robots_->enter();
    auto channel = std::make_unique<DdsChannel>(DdsChannel::Config{.domain = domain_.domain(),
                                                                   .participant_profile = "robot",
                                                                   .role = ChannelRole::kRobot,
                                                                   .name = name,
                                                                   .link = link});
    channel->prepare("cloud_1");
    return channel;
  }

  const TestNetwork domain_;
  std::optional<NetworkNamespace> robots_, clouds_;
  std::optional<SwitchedNetwork> network_;
  std::unique_ptr<ChildProgram> cloud_;  // robots ignore those of their own process
};

// The library announces a participant a few times at once, and again after 10 and 20 s.
TEST_F(LossyDiscovery, TakesSecondsAfterASilenceThatSwallowedTheFirstAnnouncements) {
  constexpr double kSilence = 11.0;
  LinkConfig silent = perfect_link();
  silent.uplink.outages.at = silent.downlink.outages.at = {{.from_s = 0.0, .for_s = kSilence}};
  const auto begin = Clock::now();
  const auto channel = robot("robot_1", silent);
  ASSERT_TRUE(matches(*channel, Topic::kSubmap, "cloud_1"));
  const double took_s = std::chrono::duration<double>(Clock::now() - begin).count();
  EXPECT_GT(took_s, kSilence - 1.0);
  EXPECT_LT(took_s, kSilence + 6.0);
}

TEST_F(LossyDiscovery, TakesSecondsWhereSevenOfTenDatagramsAreLost) {
  constexpr std::size_t kRobots = 9;
  const auto begin = Clock::now();
  std::map<std::string, std::unique_ptr<DdsChannel>> silent;
  for (std::size_t i = 0; i < kRobots; ++i) {
    LinkConfig lossy = perfect_link();
    lossy.seed = i;
    lossy.uplink.loss = lossy.downlink.loss = 0.7;
    const std::string name = "robot_" + std::to_string(i);
    silent[name] = robot(name, lossy);
  }
  const auto ask = [&](std::uint32_t number) {
    for (const auto& [name, channel] : silent) {
      channel->send("cloud_1", numbered_submap(number, name), {});
    }
    silent.begin()->second->wait_for_message(std::chrono::milliseconds(100));
    std::erase_if(silent, [](const auto& one) { return !one.second->receive({}).empty(); });
  };
  std::vector<double> answered_s;
  for (std::uint32_t number = 1; !silent.empty() && Clock::now() < begin + kPatience; ++number) {
    ask(number);
    const double now_s = std::chrono::duration<double>(Clock::now() - begin).count();
    answered_s.resize(kRobots - silent.size(), now_s);
  }
  EXPECT_THAT(answered_s, testing::SizeIs(kRobots));
  ASSERT_GT(answered_s.size(), kRobots / 2);
  EXPECT_LT(answered_s[kRobots / 2], 15.0) << testing::PrintToString(answered_s);
}

}  // namespace
}  // namespace fleetloc
