// What somebody says in the name of a robot with keys, who has none, or only another member's: from
// elsewhere, which is 127.0.0.2 here, and from its own computer.
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "test/hostile/known_robot.hpp"
#include "test/hostile/served_robot.hpp"
#include "test/hostile/wiretap.hpp"
#include "test/transport/fleet_folder.hpp"

namespace fleetloc {
namespace {

class ForgedWithKeys : public testing::Test {
 protected:
  ForgedWithKeys() { load_secure_profiles(); }

  [[nodiscard]] DdsChannel::Config member(ChannelRole role, const std::string& name) const {
    return secure_on_loopback(domain_.number(), role, name, fleet_);
  }

  const FleetFolder fleet_{"campus"};
  const TestDomain domain_;
};

class ForgedDatagramsWithKeys : public ForgedWithKeys {
 protected:
  bool next_submap_arrives() { return robot_.next_submap_arrives(cloud_); }
  bool refused(const std::string& defect, std::uint64_t times) {
    return comes_true([&] { return cloud_.diagnostics().malformed[defect] >= times; });
  }

  DdsChannel cloud_{member(ChannelRole::kCloud, "cloud_1")};
  KnownRobot robot_{domain_.number(), "secure_loopback", {.keys = fleet_.keys("robot", "robot_1")}};
};

TEST_F(ForgedDatagramsWithKeys, WhatIsNotProtectedIsRefusedAndCounted) {
  ASSERT_TRUE(next_submap_arrives());
  constexpr std::uint64_t kFar = std::uint64_t{1} << 40U;
  const Intruder beside(domain_.number(), 119);
  for (std::uint64_t ahead = 1; ahead <= 20; ++ahead)
    beside.send(robot_.forged_submap(100 + ahead));
  beside.send(robot_.forged_submap(kFar));
  beside.send(message_of({heartbeat(kFar, kFar + 5, 9, robot_.writer_id())}, robot_.prefix()));
  ASSERT_TRUE(refused("unprotected", 22));
  ASSERT_TRUE(next_submap_arrives());
  const Intruder elsewhere = Intruder::elsewhere(domain_.number(), 2);
  elsewhere.send(robot_.forged_submap(kFar));
  ASSERT_TRUE(refused("unprotected", 23));
  EXPECT_TRUE(next_submap_arrives());
}

TEST_F(ForgedDatagramsWithKeys, AMadeUpProtectionIsNotBelieved) {
  ASSERT_TRUE(next_submap_arrives());
  const Intruder beside(domain_.number(), 119);
  const Bytes clear = robot_.forged_submap(101);
  const Bytes sample(clear.begin() + kRtpsHeaderBytes, clear.end());
  for (const std::uint32_t key : {0U, 1U, 0x01020304U}) {
    beside.send(
        message_of({secure_prefix(3, 0x31, key), sample, secure_postfix(0, 0)}, robot_.prefix()));
    beside.send(message_of({secure_prefix(4, 0x31, key), secure_body(60, 60), secure_postfix(0, 0)},
                           robot_.prefix()));
    EXPECT_TRUE(next_submap_arrives());
  }
}

TEST_F(ForgedDatagramsWithKeys, WhatWasHeardIsNotDeliveredAgain) {
  if (const auto reason = Wiretap::why_impossible()) GTEST_SKIP() << *reason;
  const Wiretap wiretap(domain_.number());
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(next_submap_arrives());
  const std::vector<Bytes> heard = wiretap.heard_from(robot_.prefix());
  ASSERT_GE(heard.size(), 5U);
  ASSERT_TRUE(next_submap_arrives()) << "and with it all that was sent before it";
  const Intruder beside(domain_.number(), 119);
  const Intruder elsewhere = Intruder::elsewhere(domain_.number(), 2);
  for (const Bytes& datagram : heard) {
    beside.send(datagram);
    elsewhere.send(datagram);
  }
  ASSERT_TRUE(refused("foreign_guid", heard.size()));
  const std::uint32_t newest = robot_.number();
  EXPECT_TRUE(receives(
      cloud_,
      [&] { robot_.write(newest + 1); },
      [&](const Message& message) {
        EXPECT_GE(number_of(message), newest);
        return number_of(message) == newest + 1;
      }));
}

TEST_F(ForgedDatagramsWithKeys, NobodyElsewhereMakesARobotLeave) {
  ASSERT_TRUE(next_submap_arrives());
  const Intruder elsewhere = Intruder::elsewhere(domain_.number(), 2);
  elsewhere.send(robot_.leaves(robot_.prefix()));
  ASSERT_TRUE(refused("foreign_guid", 1));
  EXPECT_TRUE(next_submap_arrives());
}

// Only localizers may write answers; which of them has, its certificate says.
TEST_F(ForgedWithKeys, AMembersAnswerInAnothersNameIsRefusedAndCounted) {
  PlayedLocalizer cloud(member(ChannelRole::kCloud, "cloud_1"));
  PlayedRobot robot(member(ChannelRole::kRobot, "robot_1"), time_of_test());
  DdsChannel other(member(ChannelRole::kCloud, "cloud_2"));
  const auto play = [&](Timestamp now) {
    cloud.advance(now);
    robot.advance(now);
  };
  ASSERT_TRUE(plays_until([&] { return robot.answers() >= 3; }, play));
  other.prepare("robot_1");
  ASSERT_TRUE(plays_until(
      [&] { return other.matched_readers(Topic::kLocalization, "robot_1") > 0; }, play));
  const auto refused = [&] {
    const auto counts = robot.client().statistics().refused;
    const auto count = counts.find("foreign_writer");
    return count == counts.end() ? 0 : count->second;
  };
  std::uint32_t sent = 0;
  ASSERT_TRUE(plays_until([&] { return refused() >= 10; },
                          [&](Timestamp now) {
                            play(now);
                            other.send("robot_1", as_message(answer_of("cloud_1", ++sent)), now);
                            other.send("", as_message(status_of("cloud_1", Incarnation{9})), now);
                          }));
  EXPECT_TRUE(plays_until(
      [&] { return robot.channel().diagnostics().undecodable["foreign_writer"] > 0; }, play));
  const std::uint64_t answers = robot.answers();
  EXPECT_TRUE(plays_until([&] { return robot.answers() > answers; }, play)) << "served on";
  EXPECT_EQ(robot.client().statistics().localizers_chosen, 1U);
}

}  // namespace
}  // namespace fleetloc
