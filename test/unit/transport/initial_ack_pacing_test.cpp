#include "shared/transport/workarounds/initial_ack_pacing.hpp"

#include <gtest/gtest.h>

#include "test/transport/rtps_messages.hpp"

namespace fleetloc {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr milliseconds kLibraryPeriod{70};

Bytes acknowledgement(std::uint64_t base, std::uint8_t to = 7, std::uint32_t bits = 0) {
  const auto body = ByteWriter()
                        .entity(kSubscriptionsReader)
                        .entity(kPublicationsWriter)
                        .sequence_number(base)
                        .u32(bits)
                        .zeros(bits == 0 ? 0 : 4)
                        .u32(3)
                        .written();
  return message_of({submessage(0x0e, 1, Bytes(12, to)), submessage(0x06, 1, body)});
}

class InitialAckPacingTest : public testing::Test {
 protected:
  /// How many of them pass if the library sends one every 70 ms for so long.
  int passed(const Bytes& datagram, InitialAckPacing::Time::duration during) {
    int count = 0;
    for (const auto end = now_ + during; now_ < end; now_ += kLibraryPeriod) {
      count += pacing_.passes(datagram, now_) ? 1 : 0;
    }
    return count;
  }

  InitialAckPacing pacing_;
  InitialAckPacing::Time now_{seconds(1000)};
};

TEST_F(InitialAckPacingTest, LetsThroughTheFirstAndThenEverFewer) {
  EXPECT_EQ(passed(acknowledgement(0), milliseconds(70)), 1);
  EXPECT_EQ(passed(acknowledgement(0), seconds(6)), 4);
  EXPECT_LE(passed(acknowledgement(0), seconds(60)), 6);
  EXPECT_GE(passed(acknowledgement(0), seconds(60)), 4);
}

TEST_F(InitialAckPacingTest, BeginsAnewWithTheNextMatch) {
  passed(acknowledgement(0), seconds(60));
  now_ += seconds(3);
  EXPECT_EQ(passed(acknowledgement(0), seconds(1)), 3);
}

TEST_F(InitialAckPacingTest, CountsEachParticipantForItself) {
  passed(acknowledgement(0, 7), seconds(1));
  EXPECT_TRUE(pacing_.passes(acknowledgement(0, 8), now_));
}

TEST_F(InitialAckPacingTest, SpacesOutEncryptedOnesOfEachKey) {
  EXPECT_EQ(passed(encrypted_message(5, 28), seconds(6)), 5);
  EXPECT_TRUE(pacing_.passes(encrypted_message(6, 28), now_));
  EXPECT_TRUE(pacing_.passes(encrypted_message(5, 28, 8), now_));
  EXPECT_FALSE(pacing_.passes(encrypted_message(5, 28), now_));
}

TEST_F(InitialAckPacingTest, LetsThroughEncryptedAnswersToHeartbeats) {
  passed(encrypted_message(5, 28), seconds(6));
  for (int i = 0; i < 20; ++i) {
    now_ += milliseconds(400);
    EXPECT_TRUE(pacing_.passes(encrypted_message(5, 28), now_));
    EXPECT_TRUE(pacing_.passes(encrypted_message(5, 32), now_));
    EXPECT_TRUE(pacing_.passes(encrypted_message(5, 32), now_));
  }
}

TEST_F(InitialAckPacingTest, LeavesAllOtherDatagramsAlone) {
  for (int i = 0; i < 20; ++i) {
    EXPECT_TRUE(pacing_.passes(acknowledgement(1), now_));
    EXPECT_TRUE(pacing_.passes(acknowledgement(1, 7, 4), now_));
    EXPECT_TRUE(pacing_.passes(message_of({ack_nack(0)}), now_));
    EXPECT_TRUE(pacing_.passes(message_of({heartbeat(1, 4)}), now_));
    EXPECT_TRUE(pacing_.passes(Bytes(kRtpsHeaderBytes), now_));
  }
}

}  // namespace
}  // namespace fleetloc
