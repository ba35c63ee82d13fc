#include "shared/transport/workarounds/gap_budget.hpp"

#include <gtest/gtest.h>

#include "test/transport/rtps_messages.hpp"

namespace fleetloc {
namespace {

using std::chrono::hours;

constexpr std::uint64_t kMillion = 1'000'000;
constexpr GuidPrefix kWriter{1, 15, 3};
constexpr GuidPrefix kOtherWriter{1, 15, 4};

class GapBudgetTest : public testing::Test {
 protected:
  bool passes(const Bytes& datagram) { return budget_.passes(datagram, now_); }
  bool passes(std::uint64_t first, std::uint64_t numbers, const GuidPrefix& from = kWriter) {
    return passes(message_of({gap(first, first + numbers)}, from));
  }

  GapBudget budget_;
  GapBudget::Time now_{hours(1000)};
};

TEST_F(GapBudgetTest, PassesWhatWritersLeaveOut) {
  for (std::uint64_t i = 0; i < 1000; ++i) EXPECT_TRUE(passes(50 * i, 10)) << i;
  EXPECT_TRUE(passes(message_of({heartbeat(1, 2), ack_nack(3)}, kWriter)));
}

TEST_F(GapBudgetTest, EndsAfterAMillionOfOneWriter) {
  EXPECT_TRUE(passes(5, kMillion));
  EXPECT_FALSE(passes(5 + 2 * kMillion, kMillion));
  EXPECT_FALSE(passes(message_of({heartbeat(1, 2), gap(5, 5 + kMillion)}, kWriter)));
  EXPECT_TRUE(passes(5, kMillion, kOtherWriter));
}

TEST_F(GapBudgetTest, ReturnsOverADay) {
  ASSERT_TRUE(passes(5, kMillion));
  now_ += hours(6);
  EXPECT_TRUE(passes(5, kMillion / 4));
  EXPECT_FALSE(passes(5, kMillion / 4));
  now_ += hours(100);
  EXPECT_TRUE(passes(5, kMillion));
  EXPECT_FALSE(passes(5, kMillion));
}

TEST_F(GapBudgetTest, IsTheWritersWhoeverPassesItsMessagesOn) {
  const Bytes on_behalf = submessage(
      0x0c,
      1,
      ByteWriter().zeros(4).bytes({2, 3, 1, 15}).bytes({kWriter.begin(), kWriter.end()}).written());
  EXPECT_TRUE(passes(message_of({on_behalf, gap(5, 5 + kMillion)}, kOtherWriter)));
  EXPECT_FALSE(passes(5, kMillion));
  EXPECT_TRUE(passes(5, kMillion, kOtherWriter));
}

TEST_F(GapBudgetTest, IsNotReturnedToOneWriterByManyOthers) {
  ASSERT_TRUE(passes(5, kMillion));
  for (std::uint8_t i = 0; i < 100; ++i) {
    for (std::uint8_t k = 0; k < 100; ++k) EXPECT_TRUE(passes(5, 10, {2, i, k}));
  }
  EXPECT_FALSE(passes(5, kMillion));
}

TEST_F(GapBudgetTest, CountsWhatIsSignedAndPassesWhatIsEncrypted) {
  for (int i = 0; i < 1000; ++i) EXPECT_TRUE(passes(message_of(encrypted_submessage(), kWriter)));
  const auto in_signed = [](std::uint64_t first) {
    return message_of({secure_prefix(3), gap(first, first + kMillion), secure_postfix(0, 0)},
                      kWriter);
  };
  EXPECT_TRUE(passes(in_signed(5)));
  EXPECT_FALSE(passes(in_signed(5 + 2 * kMillion)));
}

}  // namespace
}  // namespace fleetloc
