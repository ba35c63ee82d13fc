#include "shared/protocol/retransmission_timer.hpp"

#include <gtest/gtest.h>

#include "test/unit/timestamps.hpp"

namespace fleetloc {
namespace {

constexpr RetransmissionTimer::Config kTimerConfig{
    .max_interval_s = 1.0, .min_interval_s = 0.2, .full_rate_loss = 0.5};

int repeats_in_ten_seconds(double loss) {
  RetransmissionTimer retransmission(kTimerConfig);
  retransmission.sent(at_ms(0));
  int count = 0;
  for (int ms = 0; ms <= 10'000; ms += 10) count += retransmission.due(at_ms(ms), loss) ? 1 : 0;
  return count;
}

TEST(RetransmissionTimer, HasNothingToRepeatBeforeTheFirstMessage) {
  EXPECT_FALSE(RetransmissionTimer(kTimerConfig).due(at_ms(10'000), 1.0));
}

TEST(RetransmissionTimer, IsTheMoreFrequentTheMoreTheNetworkLoses) {
  EXPECT_EQ(repeats_in_ten_seconds(0.0), 10);
  EXPECT_EQ(repeats_in_ten_seconds(0.5), 50);
  EXPECT_EQ(repeats_in_ten_seconds(0.9), 50);
  EXPECT_GT(repeats_in_ten_seconds(0.25), 10);
  EXPECT_LT(repeats_in_ten_seconds(0.25), 50);
}

TEST(RetransmissionTimer, StartsAnewWithANewMessage) {
  RetransmissionTimer retransmission(kTimerConfig);
  retransmission.sent(at_ms(0));
  retransmission.sent(at_ms(900));
  EXPECT_FALSE(retransmission.due(at_ms(1000), 0.0));
  EXPECT_TRUE(retransmission.due(at_ms(1900), 0.0));
}

}  // namespace
}  // namespace fleetloc
