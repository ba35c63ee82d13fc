#include "shared/link/burst_loss.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace fleetloc {
namespace {

constexpr int kLostOrNot = 200'000;
constexpr double kSigmas = 5.0;  // of what is measured

struct Setting {
  double loss, burst_length;
};

std::vector<bool> losses(const Setting& setting, std::uint64_t seed, int datagrams = kLostOrNot) {
  BurstLoss loss(setting.loss, setting.burst_length, seed);
  std::vector<bool> lost;
  lost.reserve(static_cast<std::size_t>(datagrams));
  for (int i = 0; i < datagrams; ++i) lost.push_back(loss.next());
  return lost;
}

class BurstLosses : public testing::TestWithParam<Setting> {};

// Datagrams k apart are correlated by (1 - 1 / b)^k, which makes the variance of the mean 2 b - 1
// times that of independent ones.
TEST_P(BurstLosses, AreTheShareThatIsAskedFor) {
  const auto [loss, burst_length] = GetParam();
  const std::vector<bool> lost = losses(GetParam(), 1);
  const auto count = static_cast<double>(std::ranges::count(lost, true));
  const double variance = loss * (1.0 - loss) * (2.0 * burst_length - 1.0) / kLostOrNot;
  EXPECT_NEAR(count / kLostOrNot, loss, kSigmas * std::sqrt(variance));
}

// The number in a row is geometric: its standard deviation is below its mean.
TEST_P(BurstLosses, AreAsManyInARowAsTheFormulaSays) {
  const auto [loss, burst_length] = GetParam();
  const std::vector<bool> lost = losses(GetParam(), 2);
  double bursts = 0.0;
  double count = 0.0;
  for (std::size_t i = 1; i < lost.size(); ++i) {
    if (lost[i] && !lost[i - 1]) ++bursts;
    if (lost[i]) ++count;
  }
  const double expected = burst_length / (1.0 - loss);
  EXPECT_NEAR(count / bursts, expected, kSigmas * expected / std::sqrt(bursts));
}

INSTANTIATE_TEST_SUITE_P(,
                         BurstLosses,
                         testing::Values(Setting{0.02, 1.0},
                                         Setting{0.02, 3.0},
                                         Setting{0.5, 1.0},
                                         Setting{0.5, 8.0},
                                         Setting{0.9, 1.0},
                                         Setting{0.9, 3.0}));

TEST(BurstLoss, LosesNothingOrEverythingIfToldTo) {
  for (const double burst_length : {1.0, 5.0}) {
    EXPECT_EQ(std::ranges::count(losses({0.0, burst_length}, 1, 1000), true), 0);
    EXPECT_EQ(std::ranges::count(losses({1.0, burst_length}, 1, 1000), true), 1000);
  }
}

TEST(BurstLoss, IsTheSameForTheSameSeedOnly) {
  EXPECT_EQ(losses({0.5, 3.0}, 7, 200), losses({0.5, 3.0}, 7, 200));
  EXPECT_NE(losses({0.5, 3.0}, 7, 200), losses({0.5, 3.0}, 8, 200));
}

TEST(BurstLoss, LosesAtAHigherShareWhatItLosesAtALowerOne) {
  for (const double burst_length : {1.0, 3.0}) {
    const std::vector<bool> few = losses({0.3, burst_length}, 4, 2000);
    const std::vector<bool> many = losses({0.5, burst_length}, 4, 2000);
    for (std::size_t i = 0; i < few.size(); ++i) EXPECT_LE(few[i], many[i]) << i;
  }
}

}  // namespace
}  // namespace fleetloc
