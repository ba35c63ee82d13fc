#include "shared/transport/workarounds/statistics_removal.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/transport/rtps_messages.hpp"

namespace fleetloc {
namespace {

const Bytes kStatistics = submessage(0x80, 1, Bytes(56));

Bytes without(const Bytes& datagram) {
  const RtpsBytes rest = without_statistics(datagram);
  return {rest.begin(), rest.end()};
}

Bytes data(std::size_t payload, std::uint8_t content = 0) {
  ByteWriter body;
  body.u16(0).u16(16).entity(0).entity(0x102).sequence_number(2).bytes({0, 1, 0, 0});
  body.bytes(Bytes(payload, content));
  return submessage(0x15, 1 | 4, body.written());
}

TEST(StatisticsRemoval, LeavesWhatIsBeforeThem) {
  for (const std::size_t payload : {0U, 4U, 40U, 60U, 64U, 1200U}) {
    EXPECT_EQ(without(message_of({data(payload), kStatistics})), message_of({data(payload)}));
  }
  EXPECT_EQ(without(message_of({gap(1, 3), heartbeat(1, 4), kStatistics})),
            message_of({gap(1, 3), heartbeat(1, 4)}));
}

TEST(StatisticsRemoval, LeavesADatagramAloneThatHasNone) {
  const Bytes plain = message_of({gap(1, 3), data(100)});
  EXPECT_EQ(without(plain), plain);
  EXPECT_EQ(without(message_of({})), message_of({}));
  EXPECT_EQ(without({}), Bytes{});
  // The same octets within a sample.
  const Bytes content = message_of({data(200, 0x80)});
  EXPECT_EQ(without(content), content);
}

// The library would write its statistics over the sample.
TEST(StatisticsRemoval, KeepsThemWhereTheSampleHasTheirMark) {
  const Bytes marked = message_of({data(200, 0x80), kStatistics});
  EXPECT_EQ(without(marked), marked);
}

TEST(StatisticsRemoval, LivesThroughEverything) {
  std::mt19937 random(5);
  for (int i = 0; i < 20'000; ++i) {
    const Bytes message = random_message(random);
    EXPECT_LE(without(message).size(), message.size());
  }
}

}  // namespace
}  // namespace fleetloc
