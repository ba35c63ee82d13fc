// Participants that lose their network, in a namespace where loopback's address goes and returns.
#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/system/network_namespace.hpp"
#include "test/transport/discovery_server.hpp"
#include "test/transport/test_network.hpp"
#include "test/transport/wire_samples.hpp"

namespace fleetloc {
namespace {

using std::chrono::milliseconds;
using testing::Contains;
using testing::HasSubstr;

class ParticipantRecreation : public testing::Test {
 protected:
  void SetUp() override {
    if (const auto reason = NetworkNamespace::why_impossible()) GTEST_SKIP() << *reason;
    computer_.emplace();
    const auto inside = computer_->enter();
    if (!start_discovery()) return;
    cloud_ = channel(ChannelRole::kCloud, "cloud_1");
    robot_ = channel(ChannelRole::kRobot, "robot_1");
  }

  /// What the participants need to meet; false where the test has to be skipped.
  virtual bool start_discovery() { return true; }

  [[nodiscard]] std::unique_ptr<DdsChannel> channel(ChannelRole role, const std::string& name) {
    auto end = on_loopback(network_.domain(), role, name);
    end.participant_profile = profile_;
    return std::make_unique<DdsChannel>(end);
  }

  void take_network_away() { computer_->ip("address delete 127.0.0.1/8 dev lo"); }
  void give_network_back() { computer_->ip("address add 127.0.0.1/8 dev lo"); }

  /// The network is gone and back, and both ends have noticed.
  void interrupt() {
    const auto before =
        std::pair(robot_->diagnostics().recreations, cloud_->diagnostics().recreations);
    take_network_away();
    give_network_back();
    ASSERT_TRUE(comes_true([&] {
      return robot_->diagnostics().recreations > before.first &&
             cloud_->diagnostics().recreations > before.second;
    }));
  }

  [[nodiscard]] bool submap_arrives(std::uint32_t number) {
    return submap_arrives(*robot_, number);
  }
  [[nodiscard]] bool submap_arrives(DdsChannel& from, std::uint32_t number) {
    return receives(
        *cloud_,
        [&] { from.send("cloud_1", numbered_submap(number), {}); },
        [&](const Message& message) {
          return message.topic == Topic::kSubmap && number_of(message) == number;
        });
  }

  const TestNetwork network_;
  std::string profile_ = "loopback";
  std::optional<NetworkNamespace> computer_;
  std::unique_ptr<DdsChannel> cloud_, robot_;
};

TEST_F(ParticipantRecreation, GoesOnWithItsCountsAfterTheNetworkWasGone) {
  for (std::uint32_t number = 1; number < 6; ++number) {
    ASSERT_TRUE(submap_arrives(number)) << number;
    const ChannelStatistics before = robot_->statistics();
    interrupt();
    const ChannelStatistics after = robot_->statistics();
    EXPECT_GE(after.sent_messages, before.sent_messages);
    EXPECT_GE(after.sent_wire_bytes, before.sent_wire_bytes);
    EXPECT_GE(after.received_wire_bytes, before.received_wire_bytes);
  }
  EXPECT_EQ(robot_->diagnostics().recreations, 5);
  EXPECT_THAT(robot_->take_events(), Contains(HasSubstr("addresses are now 127.0.0.1")));
}

TEST_F(ParticipantRecreation, KeepsWhatWasReceivedAndNotYetTaken) {
  ASSERT_TRUE(submap_arrives(1));
  static_cast<void>(cloud_->receive({}));
  while (!cloud_->wait_for_message(milliseconds(20))) {
    robot_->send("cloud_1", numbered_submap(2), {});
  }
  interrupt();
  const auto messages = cloud_->receive({});
  ASSERT_FALSE(messages.empty());
  EXPECT_EQ(number_of(messages.front()), 2);
}

TEST_F(ParticipantRecreation, TellsItsSessionAgainToThoseWhoComeLater) {
  robot_->send("cloud_2", session_of("robot_1"), {});
  ASSERT_TRUE(submap_arrives(1));
  interrupt();
  const auto inside = computer_->enter();
  const auto late = channel(ChannelRole::kCloud, "cloud_2");
  EXPECT_TRUE(receives(
      *late, [] {}, [](const Message& message) { return message.topic == Topic::kSession; }));
}

TEST_F(ParticipantRecreation, TellsWhatWasSaidWhileThereWasNoNetwork) {
  ASSERT_TRUE(submap_arrives(1));
  take_network_away();
  robot_->send("cloud_1", session_of("robot_1"), {});
  give_network_back();
  EXPECT_TRUE(receives(
      *cloud_, [] {}, [](const Message& message) { return message.topic == Topic::kSession; }));
}

// Whoever calls never waits for a new participant: a call between two of them comes back, its
// message unsent. There are 5 to 15 ms between two; the network goes until a call has fallen there.
TEST_F(ParticipantRecreation, KeepsNoCallerWaiting) {
  ASSERT_TRUE(submap_arrives(1));
  std::uint32_t number = 1;
  std::uint64_t interruptions = 0;
  EXPECT_TRUE(comes_true([&] {
    if (robot_->diagnostics().recreations == interruptions) {
      take_network_away();
      give_network_back();
      ++interruptions;
    }
    robot_->send("cloud_1", numbered_submap(++number), {});
    return robot_->diagnostics().unsent > 0;
  })) << "no call fell between two participants, "
      << robot_->diagnostics().recreations << " times";
}

TEST_F(ParticipantRecreation, EndsCleanlyAtAnyMoment) {
  const auto inside = computer_->enter();
  for (int i = 0; i < 12; ++i) {
    auto ending = channel(ChannelRole::kRobot, "robot_2");
    ending->send("cloud_1", session_of("robot_2"), {});
    take_network_away();
    give_network_back();
    // The new participant is made a second after the old one at the earliest.
    std::this_thread::sleep_for(milliseconds(940 + 20 * i));
    ending.reset();
  }
  EXPECT_TRUE(submap_arrives(1));
}

/// The same by a discovery server.
class ParticipantRecreationByServer : public ParticipantRecreation {
 protected:
  ParticipantRecreationByServer() { profile_ = "loopback_client"; }

  bool start_discovery() override {
    if (const auto reason = DiscoveryServer::why_impossible()) {
      [&] { GTEST_SKIP() << *reason; }();
      return false;
    }
    server_.emplace();
    return true;
  }

  std::optional<DiscoveryServer> server_;
};

// Those who have met do not notice that it is gone, but those who come after its return are found
// by nobody, unless the participants notice that it began anew.
TEST_F(ParticipantRecreationByServer, MeetsThoseWhoComeAfterTheServerWasStartedAgain) {
  const auto inside = computer_->enter();
  ASSERT_TRUE(submap_arrives(1));
  for (std::uint32_t i = 0; i < 5; ++i) {  // a longer life of the server than that after it
    ASSERT_TRUE(submap_arrives(*channel(ChannelRole::kRobot, "robot_2"), 10 + i)) << i;
  }
  for (std::uint32_t again = 1; again <= 2; ++again) {
    server_->kill();
    server_.emplace();
    const auto newcomer = channel(ChannelRole::kRobot, "robot_3");
    const auto send = [&] {
      newcomer->send("cloud_1", numbered_submap(20 + again), {});
      robot_->send("cloud_1", numbered_submap(1), {});  // the cloud is not without news meanwhile
    };
    EXPECT_TRUE(receives(*cloud_, send, [&](const Message& message) {
      return message.topic == Topic::kSubmap && number_of(message) == 20 + again;
    })) << again;
    EXPECT_TRUE(submap_arrives(30 + again)) << again;
    EXPECT_EQ(cloud_->diagnostics().recreations, again);
  }
  EXPECT_THAT(cloud_->take_events(), Contains(HasSubstr("the discovery server was started again")));
}

}  // namespace
}  // namespace fleetloc
