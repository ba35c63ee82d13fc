// Datagrams in the name of a robot that its localizer knows: from elsewhere, which is 127.0.0.2
// here, and from its own computer. Without keys.
#include <chrono>
#include <cstdint>
#include <string>

#include <fastdds/dds/core/status/PublicationMatchedStatus.hpp>
#include <gtest/gtest.h>

#include "test/hostile/known_robot.hpp"

namespace fleetloc {
namespace {

constexpr GuidPrefix kNobody{1, 15, 6, 6, 6};

class ForgedDatagrams : public testing::Test {
 protected:
  bool next_submap_arrives() { return robot_.next_submap_arrives(cloud_); }
  bool refused(const std::string& defect, std::uint64_t times) {
    return comes_true([&] { return cloud_.diagnostics().malformed[defect] >= times; });
  }

  const TestNetwork network_;
  DdsChannel cloud_{on_loopback(network_.domain(), ChannelRole::kCloud, "cloud_1")};
  KnownRobot robot_{network_.domain(), "loopback"};
};

TEST_F(ForgedDatagrams, ANumberFarAheadMakesALocalizerDeafFromNowhere) {
  ASSERT_TRUE(next_submap_arrives());
  constexpr std::uint64_t kFar = std::uint64_t{1} << 40U;
  Intruder(network_.domain(), 119).send(robot_.forged_submap(kFar));
  ASSERT_TRUE(refused("far_ahead", 1));
  ASSERT_TRUE(next_submap_arrives());
  Intruder::elsewhere(network_.domain(), 2).send(robot_.forged_submap(kFar));
  ASSERT_TRUE(refused("foreign_guid", 1));
  EXPECT_TRUE(next_submap_arrives());
}

TEST_F(ForgedDatagrams, AForeignGuidIsRefusedAndCounted) {
  ASSERT_TRUE(next_submap_arrives());
  const Intruder intruder = Intruder::elsewhere(network_.domain(), 2);
  for (std::uint64_t ahead = 1; ahead <= 20; ++ahead)
    intruder.send(robot_.forged_submap(100 + ahead));
  ASSERT_TRUE(refused("foreign_guid", 20));
  EXPECT_TRUE(next_submap_arrives());
}

TEST_F(ForgedDatagrams, WhatWasSentBeforeIsNotDeliveredAgain) {
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(next_submap_arrives());
  const Intruder beside(network_.domain(), 119);
  const Intruder elsewhere = Intruder::elsewhere(network_.domain(), 2);
  for (std::uint64_t number = 1; number <= 5; ++number) {
    beside.send(robot_.forged_submap(number));
    elsewhere.send(robot_.forged_submap(number));
  }
  ASSERT_TRUE(refused("foreign_guid", 5));
  EXPECT_TRUE(next_submap_arrives());
}

// CVE-2023-50257: by who says it in the robot's name, and by who says it of the robot.
TEST_F(ForgedDatagrams, NobodyElsewhereMakesARobotLeave) {
  ASSERT_TRUE(next_submap_arrives());
  const Intruder intruder = Intruder::elsewhere(network_.domain(), 2);
  for (const GuidPrefix& says : {robot_.prefix(), kNobody}) intruder.send(robot_.leaves(says));
  const Intruder beside(network_.domain(), 119);
  beside.send(robot_.leaves(kNobody));
  ASSERT_TRUE(refused("foreign_guid", 3));
  eprosima::fastdds::dds::PublicationMatchedStatus matched;
  robot_.writer().get_publication_matched_status(matched);
  EXPECT_EQ(matched.total_count, 1);
  EXPECT_TRUE(next_submap_arrives());
  // From its own computer and in its name it cannot be told from the truth.
  beside.send(robot_.leaves(robot_.prefix()));
  const auto before = std::chrono::steady_clock::now();
  EXPECT_TRUE(next_submap_arrives()) << "but the robot comes back";
  const std::chrono::duration<double> away = std::chrono::steady_clock::now() - before;
  RecordProperty("away_s", std::to_string(away.count()));
}

TEST_F(ForgedDatagrams, NobodyElsewhereMovesARobot) {
  ASSERT_TRUE(next_submap_arrives());
  const auto moved = [&](const GuidPrefix& says) {
    ByteWriter body;
    body.u16(0).u16(16).entity(0).entity(kParticipantWriter).sequence_number(500);
    body.bytes({0, 3, 0, 0}).u16(0x15).u16(4).bytes({2, 3, 0, 0}).u16(0x16).u16(4);
    body.bytes({1, 15, 0, 0}).u16(0x50).u16(16).bytes(robot_.guid());
    body.u16(0x31).u16(24).u32(1).u32(9).zeros(12).entity(0x7f000002).u16(1).u16(0);
    return message_of({submessage(0x15, 1 | 4, body.written())}, says);
  };
  const Intruder intruder = Intruder::elsewhere(network_.domain(), 2);
  for (const GuidPrefix& says : {robot_.prefix(), kNobody}) intruder.send(moved(says));
  ASSERT_TRUE(refused("foreign_guid", 2));
  EXPECT_TRUE(next_submap_arrives());
}

}  // namespace
}  // namespace fleetloc
