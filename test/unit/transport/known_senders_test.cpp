#include "shared/transport/workarounds/known_senders.hpp"

#include <string>

#include <gtest/gtest.h>

#include "test/transport/rtps_messages.hpp"

namespace fleetloc {
namespace {

using std::chrono::seconds;

constexpr GuidPrefix kRobot{1, 15, 7};
constexpr GuidPrefix kIntruder{1, 15, 8};
constexpr GuidPrefix kServer{0x44, 0x53};
constexpr std::uint32_t kRobotHome = 0x0a000001;
constexpr std::uint32_t kRobotHomeToo = 0x0a000002;
constexpr std::uint32_t kElsewhere = 0x0a000009;
constexpr std::uint32_t kSubmapWriter = 0x103;

Bytes guid_of(const GuidPrefix& participant) {
  return ByteWriter().bytes({participant.begin(), participant.end()}).entity(0x1c1).written();
}

/// @param of  what it is about; by `from`
Bytes announced(const GuidPrefix& of,
                const GuidPrefix& from,
                std::uint32_t also_at = kRobotHomeToo) {
  ByteWriter body;
  body.u16(0).u16(16).entity(0).entity(kParticipantWriter).sequence_number(1);
  body.bytes({0, 3, 0, 0});
  body.u16(0x50).u16(16).bytes(guid_of(of));
  body.u16(0x31).u16(24).u32(1).u32(7411).zeros(12).entity(also_at);
  body.u16(1).u16(0);
  return message_of({submessage(0x15, 1 | 4, body.written())}, from);
}
Bytes announced(const GuidPrefix& of) {
  return announced(of, of);
}

/// "`of` leaves", which is a key without data.
Bytes leaving(const GuidPrefix& of, const GuidPrefix& from) {
  ByteWriter body;
  body.u16(0).u16(16).entity(0).entity(kParticipantWriter).sequence_number(2);
  body.u16(0x70).u16(16).bytes(guid_of(of));
  body.u16(0x71).u16(4).zeros(4).u16(1).u16(0);
  return message_of({submessage(0x15, 1 | 2, body.written())}, from);
}

/// That an endpoint of `of` is there.
Bytes endpoint(const GuidPrefix& of, const GuidPrefix& from) {
  ByteWriter body;
  body.u16(0).u16(16).entity(0).entity(kPublicationsWriter).sequence_number(1);
  body.bytes({0, 3, 0, 0}).u16(0x5a).u16(16).bytes(guid_of(of)).u16(1).u16(0);
  return message_of({submessage(0x15, 1 | 4, body.written())}, from);
}

Bytes robot_sample(std::uint64_t number, const GuidPrefix& from = kRobot) {
  ByteWriter body;
  body.u16(0).u16(16).entity(0).entity(kSubmapWriter).sequence_number(number).zeros(8);
  return message_of({submessage(0x15, 1 | 4, body.written())}, from);
}

class KnownSendersTest : public testing::Test {
 protected:
  std::string defect_of(const Bytes& datagram, std::uint32_t from) {
    const auto checked = senders_.check(datagram, from, now_);
    return checked ? "" : std::string(name(checked.error()));
  }
  bool passes(const Bytes& datagram, std::uint32_t from) {
    return defect_of(datagram, from).empty();
  }

  KnownSenders senders_;
  KnownSenders::Time now_{seconds(1000)};
};

TEST_F(KnownSendersTest, NobodyElsewhereSpeaksInTheNameOfAParticipant) {
  ASSERT_TRUE(passes(announced(kRobot), kRobotHome));
  EXPECT_TRUE(passes(robot_sample(1), kRobotHome));
  EXPECT_TRUE(passes(robot_sample(2), kRobotHomeToo)) << "it has announced that one, too";
  EXPECT_TRUE(passes(robot_sample(3), 0x7f000001)) << "it sends to its own computer";
  EXPECT_EQ(defect_of(robot_sample(4), kElsewhere), "foreign_guid");
  EXPECT_EQ(defect_of(announced(kRobot, kRobot, kElsewhere), kElsewhere), "foreign_guid");
  EXPECT_EQ(defect_of(leaving(kRobot, kRobot), kElsewhere), "foreign_guid");
  EXPECT_EQ(senders_.address_of(kRobot), kRobotHome);
}

TEST_F(KnownSendersTest, NobodyHidesBehindAnotherHeader) {
  ASSERT_TRUE(passes(announced(kRobot), kRobotHome));
  const Bytes source =
      submessage(0x0c, 1, ByteWriter().zeros(8).bytes({kRobot.begin(), kRobot.end()}).written());
  EXPECT_EQ(defect_of(message_of({source, heartbeat(1, 2)}, kIntruder), kElsewhere),
            "foreign_guid");
  EXPECT_TRUE(passes(message_of({source, heartbeat(1, 2)}, kRobot), kRobotHome));
}

TEST_F(KnownSendersTest, NobodyButAServerSpeaksOfOthers) {
  for (const auto& of_another : {announced(kRobot, kIntruder, kElsewhere),
                                 leaving(kRobot, kIntruder),
                                 endpoint(kRobot, kIntruder)}) {
    EXPECT_EQ(defect_of(of_another, kElsewhere), "foreign_guid");
  }
  EXPECT_TRUE(passes(endpoint(kRobot, kRobot), kRobotHome));
  senders_.watch({kServer});
  EXPECT_TRUE(passes(announced(kRobot, kServer), kElsewhere));
  EXPECT_TRUE(passes(endpoint(kRobot, kServer), kElsewhere));
  EXPECT_TRUE(passes(leaving(kRobot, kServer), kElsewhere));
}

TEST_F(KnownSendersTest, WhomAServerHasToldOfSendsFromWhereItIsHeardFirst) {
  constexpr std::uint32_t kTranslated = 0x0a000005;
  senders_.watch({kServer});
  ASSERT_TRUE(passes(announced(kRobot, kServer), kRobotHome));
  EXPECT_FALSE(senders_.address_of(kRobot));
  EXPECT_TRUE(passes(robot_sample(1), kTranslated));
  EXPECT_EQ(senders_.address_of(kRobot), kTranslated);
  EXPECT_FALSE(passes(robot_sample(2), kElsewhere));
}

TEST_F(KnownSendersTest, WhoIsSilentForLongMayHaveMoved) {
  ASSERT_TRUE(passes(announced(kRobot), kRobotHome));
  now_ += KnownSenders::kSilence;
  EXPECT_FALSE(passes(robot_sample(1), kElsewhere));
  now_ += seconds(1);
  EXPECT_TRUE(passes(robot_sample(1), kElsewhere));
  EXPECT_EQ(senders_.address_of(kRobot), kElsewhere);
  EXPECT_FALSE(passes(robot_sample(2), kRobotHomeToo + 100));
}

TEST_F(KnownSendersTest, ANumberThatNoWriterHasReachedIsRefusedWhereverItStands) {
  constexpr std::uint64_t kFar = 1U << 20U;
  ASSERT_TRUE(passes(announced(kRobot), kRobotHome));
  ASSERT_TRUE(passes(robot_sample(5), kRobotHome));
  EXPECT_EQ(defect_of(robot_sample(kFar), kRobotHome), "far_ahead");
  const auto of_submaps = [&](const Bytes& one) { return message_of({one}, kRobot); };
  EXPECT_EQ(defect_of(of_submaps(heartbeat(kFar, kFar, 1, kSubmapWriter)), kRobotHome),
            "far_ahead");
  EXPECT_EQ(defect_of(of_submaps(data_frag(1, 3000, kSubmapWriter)), kRobotHome), "");
  ASSERT_TRUE(passes(message_of({heartbeat(1, 2)}, kRobot), kRobotHome));
  EXPECT_EQ(defect_of(of_submaps(gap(3, kFar)), kRobotHome), "far_ahead");
  EXPECT_TRUE(passes(robot_sample(6), kRobotHome)) << "and the real ones go on";
}

TEST_F(KnownSendersTest, OfOneAddressNotTooManyAreNewAndOthersAreStillLetIn) {
  const auto newcomer = [](int i) {
    return GuidPrefix{1, 15, static_cast<std::uint8_t>(i >> 8), static_cast<std::uint8_t>(i), 1};
  };
  int taken = 0;
  for (int i = 0; i < 5000; ++i) taken += passes(announced(newcomer(i)), kElsewhere) ? 1 : 0;
  EXPECT_EQ(taken, static_cast<int>(NewcomerBudget::kOfAddress));
  EXPECT_EQ(defect_of(announced(newcomer(4999)), kElsewhere), "too_many_senders");
  EXPECT_TRUE(passes(announced(newcomer(0)), kElsewhere)) << "is known";
  EXPECT_TRUE(passes(announced(kRobot), kRobotHome));
  EXPECT_EQ(senders_.participants(), 1001U);
}

TEST_F(KnownSendersTest, ForgetsWhoWasHeardLeastRecently) {
  ASSERT_TRUE(passes(announced(kRobot), kRobotHome));
  for (std::uint32_t i = 0; i < KnownSenders::kMaxParticipants; ++i) {
    now_ += seconds(1);
    ASSERT_TRUE(passes(robot_sample(i + 1), kRobotHome));
    const GuidPrefix newcomer{
        1, 15, static_cast<std::uint8_t>(i >> 8U), static_cast<std::uint8_t>(i), 1};
    ASSERT_TRUE(passes(announced(newcomer), kElsewhere + i));
  }
  EXPECT_EQ(senders_.participants(), KnownSenders::kMaxParticipants);
  EXPECT_EQ(senders_.address_of(kRobot), kRobotHome) << "it was heard all the time";
}

}  // namespace
}  // namespace fleetloc
