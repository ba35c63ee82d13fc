// What is on the wire beside the samples: announcements now and then, and nothing that goes on and
// on.
#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "shared/link/datagrams.hpp"
#include "test/system/child_program.hpp"
#include "test/system/network_namespace.hpp"
#include "test/transport/test_network.hpp"
#include "test/transport/wire_samples.hpp"

namespace fleetloc {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using std::chrono::seconds;

/// Above it are the samples, below it announcements: 444 bytes to each participant every 10 s, and
/// as a multicast.
constexpr double kOverheadPerSecond = 300.0;

/// On one computer a robot, a localizer in another process, and a pose that this process publishes.
class WireOverhead : public testing::Test {
 protected:
  void SetUp() override {
    if (const auto reason = NetworkNamespace::why_impossible()) GTEST_SKIP() << *reason;
    computer_.emplace();
    network_.emplace(true);
    network_->plug_in(*computer_, "10.77.0.1");
    const auto inside = computer_->enter();
    const std::string domain = std::to_string(domain_.domain());
    localizer_ =
        std::make_unique<ChildProgram>(TRANSPORT_PEER, std::vector<std::string>{domain, "cloud"});
  }

  void start_robot(const LinkConfig& link) {
    const auto inside = computer_->enter();
    robot_ = std::make_unique<DdsChannel>(DdsChannel::Config{.domain = domain_.domain(),
                                                             .participant_profile = "robot",
                                                             .role = ChannelRole::kRobot,
                                                             .name = "robot_1",
                                                             .link = link});
    robot_->prepare("cloud_1");
  }
  void start_robot() {
    start_robot(perfect_link());
    ASSERT_TRUE(matches(*robot_, Topic::kSubmap, "cloud_1"));
    overhead(seconds(3), seconds(3));  // discovery ends
  }

  struct PerSecond {
    double up = 0.0, down = 0.0;
  };
  /// Of the wire bytes of the robot, those that no sample accounts for.
  PerSecond overhead(milliseconds submap_period, seconds during) {
    const auto begin = Clock::now();
    const ChannelStatistics before = robot_->statistics();
    std::size_t up = 0;
    std::size_t down = 0;
    for (std::uint32_t number = 1; Clock::now() < begin + during; ++number) {
      if (submap_period < during) {
        const Message submap = numbered_submap(number, "robot_1", 200);
        up += datagram_sizes(submap.payload.size()).front();
        robot_->send("cloud_1", submap, {});
      }
      const auto next = std::min(begin + number * submap_period, begin + during);
      while (Clock::now() < next) {
        robot_->wait_for_message(std::chrono::duration_cast<milliseconds>(next - Clock::now()));
        for (const Message& answer : robot_->receive({})) {
          down += datagram_sizes(answer.payload.size()).front();
        }
      }
    }
    const ChannelStatistics after = robot_->statistics();
    const auto rate = [&](std::uint64_t bytes, std::size_t samples) {
      return (static_cast<double>(bytes) - static_cast<double>(samples)) /
             static_cast<double>(during.count());
    };
    return {.up = rate(after.sent_wire_bytes - before.sent_wire_bytes, up),
            .down = rate(after.received_wire_bytes - before.received_wire_bytes, down)};
  }

  const TestNetwork domain_;
  std::optional<NetworkNamespace> computer_;
  std::optional<SwitchedNetwork> network_;
  std::unique_ptr<ChildProgram> localizer_;
  std::unique_ptr<DdsChannel> robot_;
};

TEST_F(WireOverhead, IsSmallBesideSubmapsAndAnswers) {
  start_robot();
  const PerSecond bytes = overhead(milliseconds(500), seconds(10));
  EXPECT_LT(bytes.up, kOverheadPerSecond);
  EXPECT_LT(bytes.down, kOverheadPerSecond);
}

TEST_F(WireOverhead, IsSmallAtRest) {
  start_robot();
  const PerSecond bytes = overhead(seconds(10), seconds(10));
  EXPECT_LT(bytes.up, kOverheadPerSecond);
  EXPECT_LT(bytes.down, kOverheadPerSecond);
}

// It hears the localizer, which never answers what the robot's readers ask for. The heartbeats of
// discovery go on, each second.
TEST_F(WireOverhead, IsBoundedWhileARobotIsNotHeard) {
  LinkConfig deaf = perfect_link();
  deaf.uplink.loss = 1.0;
  start_robot(deaf);
  ASSERT_TRUE(comes_true([&] { return robot_->statistics().received_wire_bytes > 0; }));
  overhead(seconds(3), seconds(3));
  const PerSecond bytes = overhead(seconds(10), seconds(10));
  EXPECT_LT(bytes.up, 2 * kOverheadPerSecond);
}

}  // namespace
}  // namespace fleetloc
