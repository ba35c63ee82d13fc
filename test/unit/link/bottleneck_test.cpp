#include "shared/link/bottleneck.hpp"

#include <gtest/gtest.h>

namespace fleetloc {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::size_t kQueue = 100'000;

Bottleneck traced(std::vector<RateStep> steps, double repeat_s = 0.0, double limit = 0.0) {
  return {limit, {.steps = std::move(steps), .repeat_s = repeat_s}, kQueue};
}

TEST(Bottleneck, IsNoneWithoutARate) {
  Bottleneck none(0.0, {}, 0);
  EXPECT_EQ(none.departure(seconds(3), 1'000'000), seconds(3));
}

TEST(Bottleneck, SendsOneDatagramAfterTheOtherAtItsRate) {
  Bottleneck bottleneck(10'000.0, {}, kQueue);
  EXPECT_EQ(bottleneck.departure({}, 1000), milliseconds(100));
  EXPECT_EQ(bottleneck.departure({}, 500), milliseconds(150));
  EXPECT_EQ(bottleneck.departure(milliseconds(500), 1000), milliseconds(600)) << "it is free again";
}

TEST(Bottleneck, DropsWhatItsQueueCannotHold) {
  Bottleneck bottleneck(1000.0, {}, 2000);
  EXPECT_TRUE(bottleneck.departure({}, 1000));
  EXPECT_TRUE(bottleneck.departure({}, 1000));
  EXPECT_FALSE(bottleneck.departure({}, 1000));
  // Half of the first has left; 500 bytes fit, and what was refused takes no time.
  EXPECT_EQ(bottleneck.departure(milliseconds(500), 500), milliseconds(2500));
}

TEST(Bottleneck, ChangesItsRateAtTheTimesOfItsTrace) {
  Bottleneck bottleneck = traced({{0.0, 1000.0}, {2.0, 4000.0}});
  EXPECT_EQ(bottleneck.departure({}, 1000), seconds(1));
  // One second at the first rate, and a quarter at the second.
  EXPECT_EQ(bottleneck.departure(seconds(1), 2000), milliseconds(2250));
  EXPECT_EQ(bottleneck.departure(seconds(100), 4000), seconds(101)) << "the last one holds";
}

TEST(Bottleneck, RepeatsItsTrace) {
  Bottleneck bottleneck = traced({{0.0, 1000.0}, {2.0, 4000.0}}, 3.0);
  // A period carries 6000 bytes, 2000 of them in its first two seconds.
  EXPECT_EQ(bottleneck.departure({}, 13'000), seconds(7));
  EXPECT_EQ(bottleneck.departure(seconds(3002), 4000), seconds(3003));
}

TEST(Bottleneck, HoldsBackWhatComesWhileItsRateIsZero) {
  Bottleneck bottleneck = traced({{0.0, 1000.0}, {1.0, 0.0}, {5.0, 1000.0}});
  EXPECT_EQ(bottleneck.departure({}, 1500), milliseconds(5500));
  EXPECT_EQ(bottleneck.departure(seconds(3), 500), seconds(6));
}

TEST(Bottleneck, CountsWhatWaitsInBytesHoweverLongItWill) {
  Bottleneck bottleneck(
      0.0, {.steps = {{0.0, 1000.0}, {1.0, 0.0}, {5.0, 1000.0}}, .repeat_s = 0.0}, 2000);
  EXPECT_TRUE(bottleneck.departure({}, 2000));
  EXPECT_FALSE(bottleneck.departure(milliseconds(900), 1000)) << "1100 wait";
  EXPECT_TRUE(bottleneck.departure(seconds(4), 1000)) << "1000 wait";
}

TEST(Bottleneck, NeverSendsBehindATraceThatEndsWithZero) {
  Bottleneck bottleneck = traced({{0.0, 1000.0}, {1.0, 0.0}});
  EXPECT_EQ(bottleneck.departure({}, 1000), seconds(1));
  EXPECT_FALSE(bottleneck.departure({}, 1));
}

TEST(Bottleneck, TakesTheSmallerOfRateAndTrace) {
  Bottleneck bottleneck = traced({{0.0, 1000.0}, {2.0, 4000.0}}, 0.0, 2000.0);
  EXPECT_EQ(bottleneck.departure({}, 1000), seconds(1));
  EXPECT_EQ(bottleneck.departure(seconds(2), 4000), seconds(4));
}

}  // namespace
}  // namespace fleetloc
