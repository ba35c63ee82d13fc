#include "shared/transport/workarounds/datagram_check.hpp"

#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "test/transport/rtps_messages.hpp"

namespace fleetloc {
namespace {

TEST(RtpsCheck, TakesEveryKindOfSubmessage) {
  for (const auto& [name, submessage] : valid_submessages()) {
    EXPECT_TRUE(is_well_formed_rtps(message_of({submessage}))) << name;
  }
  const Bytes statistics = submessage(0x80, 1, Bytes(56));
  EXPECT_TRUE(is_well_formed_rtps(message_of({heartbeat(1, 2), data_frag(1, 3000), statistics})));
  EXPECT_TRUE(is_well_formed_rtps(message_of({})));
}

TEST(RtpsCheck, RefusesWhatIsCutOffAnywhere) {
  for (const auto& [name, submessage] : valid_submessages()) {
    const Bytes whole = message_of({submessage});
    for (std::size_t size = 0; size < whole.size(); ++size) {
      if (size == message_of({}).size()) continue;  // nothing but the header
      EXPECT_FALSE(is_well_formed_rtps({whole.data(), size})) << name << " of " << size << " bytes";
    }
  }
}

TEST(RtpsCheck, RefusesAnotherProtocolAndAnotherMajorVersion) {
  Bytes message = message_of({});
  message[0] = 'X';
  EXPECT_FALSE(is_well_formed_rtps(message));
  message = message_of({});
  message[4] = 3;
  EXPECT_FALSE(is_well_formed_rtps(message));
}

TEST(RtpsCheck, TakesStatisticsOnlyWhereFastDdsPutsThem) {
  const Bytes statistics = submessage(0x80, 1, Bytes(56));
  EXPECT_TRUE(is_well_formed_rtps(message_of({heartbeat(1, 2), statistics})));
  EXPECT_FALSE(is_well_formed_rtps(message_of({statistics, heartbeat(1, 2)})));
  EXPECT_FALSE(is_well_formed_rtps(message_of({submessage(0x80, 1, Bytes(52))})));
  EXPECT_FALSE(is_well_formed_rtps(message_of({submessage(0x81, 1, Bytes(56))})));
}

TEST(RtpsCheck, RefusesASetOfMoreThan256Numbers) {
  EXPECT_TRUE(is_well_formed_rtps(message_of({ack_nack(256)})));
  EXPECT_FALSE(is_well_formed_rtps(message_of({ack_nack(257)})));
  EXPECT_FALSE(is_well_formed_rtps(message_of({ack_nack(0xffffffff)})));
}

TEST(RtpsCheck, RefusesAHeartbeatThatEndsBeforeItBegins) {
  EXPECT_TRUE(is_well_formed_rtps(message_of({heartbeat(3, 2)})));  // an empty history
  EXPECT_FALSE(is_well_formed_rtps(message_of({heartbeat(3, 1)})));
  EXPECT_FALSE(is_well_formed_rtps(message_of({heartbeat(0, 5)})));
}

TEST(RtpsCheck, RefusesRangesThatWouldTakeForeverToWalkThrough) {
  constexpr std::uint64_t kFar = std::uint64_t{1} << 40U;
  EXPECT_TRUE(is_well_formed_rtps(message_of({heartbeat(kFar, kFar + 10)})));
  EXPECT_FALSE(is_well_formed_rtps(message_of({heartbeat(1, kFar)})));
  EXPECT_TRUE(is_well_formed_rtps(message_of({gap(kFar, kFar + 10)})));
  EXPECT_FALSE(is_well_formed_rtps(message_of({gap(1, kFar)})));
  EXPECT_FALSE(is_well_formed_rtps(message_of({gap(5, 4)})));
}

TEST(RtpsCheck, RefusesFragmentsBeyondTheSample) {
  EXPECT_TRUE(is_well_formed_rtps(message_of({data_frag(1, 3000)})));
  EXPECT_TRUE(is_well_formed_rtps(message_of({data_frag(3, 3000)})));
  EXPECT_FALSE(is_well_formed_rtps(message_of({data_frag(4, 3000)})));
  EXPECT_FALSE(is_well_formed_rtps(message_of({data_frag(0, 3000)})));
  EXPECT_FALSE(is_well_formed_rtps(message_of({data_frag(1, 0x7fffffff)})));
}

TEST(RtpsCheck, RefusesParametersThatRunOverTheEnd) {
  EXPECT_TRUE(is_well_formed_rtps(message_of({announcement({{0x0015, 4}, {0x0050, 16}})})));
  EXPECT_FALSE(is_well_formed_rtps(message_of({announcement({{0x0015, 4}, {0x0050, 18}})})));
  Bytes endless = announcement({{0x0015, 4}});
  endless[endless.size() - 4] = 0x15;  // in place of the sentinel
  EXPECT_FALSE(is_well_formed_rtps(message_of({endless})));
}

TEST(RtpsCheck, ReadsNoByteBeyondTheDatagram) {  // under AddressSanitizer
  std::mt19937 random(3);
  int taken = 0;
  for (int trial = 0; trial < 20'000; ++trial) {
    Bytes message = random_message(random);
    message.shrink_to_fit();
    if (is_well_formed_rtps(message)) ++taken;
  }
  EXPECT_GT(taken, 1000);
  EXPECT_LT(taken, 19'000);
}

}  // namespace
}  // namespace fleetloc
