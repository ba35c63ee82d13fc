#include "shared/protocol/repetition.hpp"

#include <gtest/gtest.h>

namespace fleetloc {
namespace {

using std::chrono::milliseconds;

Timestamp at(int ms) {
  return Timestamp{milliseconds(ms)};
}

constexpr Repetition::Config kConfig{
    .slowest_interval_s = 1.0, .fastest_interval_s = 0.2, .full_rate_loss = 0.5};

int repeats_in_ten_seconds(double loss) {
  Repetition repetition(kConfig);
  repetition.sent(at(0));
  int count = 0;
  for (int ms = 0; ms <= 10'000; ms += 10) count += repetition.due(at(ms), loss) ? 1 : 0;
  return count;
}

TEST(Repetition, HasNothingToRepeatBeforeTheFirstMessage) {
  EXPECT_FALSE(Repetition(kConfig).due(at(10'000), 1.0));
}

TEST(Repetition, IsTheMoreFrequentTheMoreTheNetworkLoses) {
  EXPECT_EQ(repeats_in_ten_seconds(0.0), 10);
  EXPECT_EQ(repeats_in_ten_seconds(0.5), 50);
  EXPECT_EQ(repeats_in_ten_seconds(0.9), 50);
  EXPECT_GT(repeats_in_ten_seconds(0.25), 10);
  EXPECT_LT(repeats_in_ten_seconds(0.25), 50);
}

TEST(Repetition, StartsAnewWithANewMessage) {
  Repetition repetition(kConfig);
  repetition.sent(at(0));
  repetition.sent(at(900));
  EXPECT_FALSE(repetition.due(at(1000), 0.0));
  EXPECT_TRUE(repetition.due(at(1900), 0.0));
}

}  // namespace
}  // namespace fleetloc
