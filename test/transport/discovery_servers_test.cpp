// Discovery servers that die and come back.
#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "test/system/network_namespace.hpp"
#include "test/transport/discovery_server.hpp"
#include "test/transport/test_network.hpp"
#include "test/transport/wire_samples.hpp"

namespace fleetloc {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class DiscoveryServers : public testing::Test {
 protected:
  void SetUp() override {
    if (const auto reason = NetworkNamespace::why_impossible()) GTEST_SKIP() << *reason;
    if (const auto reason = DiscoveryServer::why_impossible()) GTEST_SKIP() << *reason;
    computer_.emplace();
  }

  [[nodiscard]] std::unique_ptr<DdsChannel> channel(ChannelRole role, const std::string& name) {
    auto end = on_loopback(network_.domain(), role, name);
    end.participant_profile = profile_;
    return std::make_unique<DdsChannel>(end);
  }

  /// A robot that begins now is discovered.
  [[nodiscard]] bool meets_newcomer(const std::string& name, std::uint32_t number) {
    const auto newcomer = channel(ChannelRole::kRobot, name);
    return receives(
        *cloud_,
        [&] { newcomer->send("cloud_1", numbered_submap(number, name), {}); },
        [&](const Message& message) {
          return message.topic == Topic::kSubmap && number_of(message) == number;
        });
  }

  const TestNetwork network_;
  std::string profile_ = "loopback_client_of_two";
  std::optional<NetworkNamespace> computer_;
  std::array<std::optional<DiscoveryServer>, 2> servers_;
  std::unique_ptr<DdsChannel> cloud_;
};

class EitherDiscoveryServer : public DiscoveryServers,
                              public testing::WithParamInterface<std::size_t> {};

TEST_P(EitherDiscoveryServer, MayDie) {
  const auto inside = computer_->enter();
  servers_[0].emplace(0, "");
  servers_[1].emplace(1, "");
  cloud_ = channel(ChannelRole::kCloud, "cloud_1");
  ASSERT_TRUE(meets_newcomer("robot_1", 1));
  servers_.at(GetParam())->kill();
  EXPECT_TRUE(meets_newcomer("robot_2", 2));
  cloud_ = channel(ChannelRole::kCloud, "cloud_1");
  EXPECT_TRUE(meets_newcomer("robot_3", 3)) << "none of whom has ever heard the dead one";
}

INSTANTIATE_TEST_SUITE_P(Of, EitherDiscoveryServer, testing::Values(0U, 1U), [](const auto& it) {
  return it.param == 0 ? "First" : "Second";
});

TEST_F(DiscoveryServers, AreAskedSeldomWhileTheyAreDead) {
  constexpr double kBytesPerSecond = 330.0;  // 150 are announcements to the other one
  const auto inside = computer_->enter();
  servers_[0].emplace(0, "");
  cloud_ = channel(ChannelRole::kCloud, "cloud_1");
  ASSERT_TRUE(meets_newcomer("robot_1", 1));
  const auto wait = [&](seconds during) {
    const auto end = std::chrono::steady_clock::now() + during;
    while (std::chrono::steady_clock::now() < end) cloud_->wait_for_message(milliseconds(100));
    return static_cast<double>(cloud_->statistics().sent_wire_bytes);
  };
  const double before = wait(seconds(15));
  EXPECT_LT(wait(seconds(15)) - before, 15 * kBytesPerSecond);
}

TEST_F(DiscoveryServers, ThatGoOnFromTheirBackupLetNobodyStartAnew) {
  profile_ = "loopback_client";
  const ScratchFolder scratch;
  std::filesystem::create_directory(scratch / "backup");
  const auto inside = computer_->enter();
  servers_[0].emplace(0, scratch / "backup");
  cloud_ = channel(ChannelRole::kCloud, "cloud_1");
  ASSERT_TRUE(meets_newcomer("robot_1", 1));
  for (std::uint32_t number = 2; number < 4; ++number) {
    servers_[0]->kill();
    servers_[0].emplace(0, scratch / "backup");
    EXPECT_TRUE(meets_newcomer("robot_" + std::to_string(number), number)) << number;
  }
  EXPECT_EQ(cloud_->diagnostics().recreations, 0);
}

}  // namespace
}  // namespace fleetloc
