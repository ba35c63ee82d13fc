// Ten thousand datagrams a second for three seconds, to a localizer that serves a robot, without
// keys and with them: the robot is served on, and no memory is filled.
#include <atomic>
#include <chrono>
#include <cstdint>
#include <fstream>
#include <functional>
#include <optional>
#include <random>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <unistd.h>

#include "test/hostile/served_robot.hpp"
#include "test/transport/fleet_folder.hpp"
#include "test/transport/intruder.hpp"

namespace fleetloc {
namespace {

constexpr int kDatagrams = 30'000;
constexpr int kBurst = 100;
constexpr std::chrono::milliseconds kBetweenBursts{10};
constexpr std::size_t kMegabyte = 1U << 20U;

std::size_t resident_bytes() {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages >> pages;
  return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

/// A fleet on loopback, with keys or without.
class FloodedFleet {
 public:
  explicit FloodedFleet(bool has_keys) {
    load_secure_profiles();  // with the endpoints of all others
    if (has_keys) keys_.emplace("campus");
  }

  [[nodiscard]] DdsChannel::Config member(ChannelRole role, const std::string& name) const {
    if (!keys_) return on_loopback(domain_.number(), role, name);
    return secure_on_loopback(domain_.number(), role, name, *keys_);
  }
  [[nodiscard]] std::uint32_t domain() const { return domain_.number(); }

 private:
  const TestDomain domain_;
  std::optional<FleetFolder> keys_;
};

/// By whether the fleet has keys.
class Flood : public testing::TestWithParam<bool> {
 protected:
  void SetUp() override {
    ASSERT_TRUE(plays_until([&] { return robot_.answers() >= 3; }, play()));
    ASSERT_TRUE(
        plays_until([&] { return !robot_.client().statistics().localizer.empty(); }, play()));
    chosen_ = robot_.client().statistics().localizers_chosen;
    before_ = resident_bytes();
  }

  std::function<void(Timestamp)> play() {
    return [this](Timestamp now) {
      cloud_.advance(now);
      robot_.advance(now);
    };
  }

  /// Lets it flood while both are played.
  void flood(const std::function<void(int)>& send) {
    const std::uint64_t answers = robot_.answers();
    std::atomic<bool> is_over = false;
    const std::jthread flooding([&] {
      auto next = std::chrono::steady_clock::now();
      for (int i = 0; i < kDatagrams; ++i) {
        send(i);
        if (i % kBurst == kBurst - 1) std::this_thread::sleep_until(next += kBetweenBursts);
      }
      is_over = true;
    });
    ASSERT_TRUE(plays_until([&] { return is_over.load(); }, play()));
    const std::uint64_t meanwhile = robot_.answers() - answers;
    RecordProperty("answers", std::to_string(meanwhile));
    EXPECT_GE(meanwhile, 5U);
    EXPECT_TRUE(plays_until([&] { return robot_.answers() > answers + meanwhile; }, play()));
    EXPECT_EQ(robot_.client().statistics().localizers_chosen, chosen_) << "it was never lost";
  }

  void expect_no_more_than(std::size_t bytes) {
    const std::size_t after = resident_bytes();
    const std::size_t grown = after > before_ ? after - before_ : 0;
    RecordProperty("megabytes", std::to_string(grown / kMegabyte));
    EXPECT_LT(grown, bytes);
  }

  const FloodedFleet fleet_{GetParam()};
  PlayedLocalizer cloud_{fleet_.member(ChannelRole::kCloud, "cloud_1")};
  PlayedRobot robot_{fleet_.member(ChannelRole::kRobot, "robot_1"), time_of_test()};
  std::uint64_t chosen_ = 0;
  std::size_t before_ = 0;
};

TEST_P(Flood, OfGarbageTakesNoAnswersAway) {
  const Intruder intruder = Intruder::elsewhere(fleet_.domain(), 2);
  const auto ports = intruder.ports_in_use();
  ASSERT_GE(ports.size(), 4U);
  std::mt19937 random(7);
  flood([&](int i) {
    const Bytes datagram = i % 2 == 0 ? random_message(random) : Bytes(random() % 1400, 0x52);
    intruder.send_to_port(ports[random() % ports.size()], datagram);
  });
  const auto malformed = cloud_.channel().diagnostics().malformed;
  EXPECT_GT(malformed.at("not_rtps"), 100U) << "it has arrived";
  EXPECT_GT(malformed.at("invalid_submessage"), 100U);
  expect_no_more_than(50 * kMegabyte);
}

TEST_P(Flood, OfNewParticipantsTakesNoAnswersAwayAndARobotStillGetsIn) {
  const Bytes announced = [&] {
    const Intruder listener(fleet_.domain(), 119);
    const DdsChannel other(fleet_.member(ChannelRole::kRobot, "robot_9"));
    return listener.hear();
  }();
  ASSERT_GT(announced.size(), 100U);
  const Intruder intruder = Intruder::elsewhere(fleet_.domain(), 2);
  const auto ports = intruder.ports_in_use();
  ASSERT_GE(ports.size(), 4U);
  flood([&](int i) {
    const GuidPrefix newcomer{
        1, 15, 6, 6, static_cast<std::uint8_t>(i >> 8), static_cast<std::uint8_t>(i), 6, 6};
    intruder.send_to_port(ports[static_cast<std::size_t>(i) % ports.size()],
                          with_prefix(announced, newcomer));
  });
  EXPECT_GT(cloud_.channel().diagnostics().malformed["too_many_senders"], 1000U);
  expect_no_more_than(200 * kMegabyte);
  PlayedRobot newcomer(fleet_.member(ChannelRole::kRobot, "robot_2"), time_of_test());
  EXPECT_TRUE(plays_until([&] { return newcomer.answers() > 0; },
                          [&](Timestamp now) {
                            play()(now);
                            newcomer.advance(now);
                          }));
}

TEST_P(Flood, OfSubmapsFromAThousandIdsTakesNoAnswersAway) {
  DdsChannel intruder(fleet_.member(ChannelRole::kRobot, "mallory"));
  ASSERT_TRUE(matches(intruder, Topic::kSubmap, "cloud_1"));
  ASSERT_TRUE(matches(intruder, Topic::kSession, "cloud_1"));
  flood([&](int i) {
    const RobotId id = "id_" + std::to_string(i % 1000);
    intruder.send("cloud_1", as_message(submap_of(id, static_cast<std::uint32_t>(i))), {});
    if (i < 1000) intruder.send("cloud_1", as_message(session_for(id)), {});
  });
  EXPECT_LE(cloud_.pool()->sessions(), 2U);
  const std::uint64_t refused = GetParam()
                                    ? cloud_.channel().diagnostics().undecodable["foreign_writer"]
                                    : cloud_.pool().refused("id_7", "foreign_writer");
  EXPECT_GT(refused, 1000U);
  expect_no_more_than(100 * kMegabyte);
}

INSTANTIATE_TEST_SUITE_P(Fleet, Flood, testing::Bool(), [](const auto& one) {
  return one.param ? "WithKeys" : "WithoutKeys";
});

}  // namespace
}  // namespace fleetloc
