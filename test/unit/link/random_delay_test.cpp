#include "shared/link/random_delay.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace fleetloc {
namespace {

using std::chrono::milliseconds;

constexpr int kDelayed = 20'000;

std::vector<double> delays_s(const DelayConfig& config, std::uint64_t seed = 1) {
  const RandomDelay delay(config, seed);
  std::vector<double> delays;
  for (std::uint64_t i = 0; i < kDelayed; ++i) delays.push_back(to_seconds(delay.of(i)));
  return delays;
}

TEST(RandomDelay, IsTheSameForEachDatagramWithoutJitter) {
  const RandomDelay delay({.delay_s = 0.25}, 1);
  for (std::uint64_t i = 0; i < 100; ++i) EXPECT_EQ(delay.of(i), milliseconds(250));
}

// The largest distance of the measured distribution from the true one (Kolmogorov, Smirnov) is
// above 2.2 / sqrt(n) once in 10,000 times.
TEST(RandomDelay, HasAnExponentialJitter) {
  constexpr double kDelay = 0.1;
  constexpr double kJitter = 0.05;
  std::vector<double> delays = delays_s({.delay_s = kDelay, .jitter_s = kJitter});
  std::ranges::sort(delays);
  double distance = 0.0;
  for (std::size_t i = 0; i < delays.size(); ++i) {
    const double expected = 1.0 - std::exp(-(delays[i] - kDelay) / kJitter);
    const double measured = (static_cast<double>(i) + 0.5) / kDelayed;
    distance = std::max(distance, std::abs(measured - expected));
  }
  EXPECT_LT(distance, 2.2 / std::sqrt(kDelayed));
}

// As RFC 3550 measures it. The difference is exponential again, with the same mean; neighbouring
// ones share a datagram, which makes the variance of the mean less than three times as large.
TEST(RandomDelay, DiffersByTheJitterFromOneDatagramToTheNext) {
  constexpr double kJitter = 0.05;
  const std::vector<double> delays = delays_s({.jitter_s = kJitter}, 2);
  double sum = 0.0;
  for (std::size_t i = 1; i < delays.size(); ++i) sum += std::abs(delays[i] - delays[i - 1]);
  EXPECT_NEAR(sum / (kDelayed - 1), kJitter, 5.0 * kJitter * std::sqrt(3.0 / kDelayed));
}

TEST(RandomDelay, HoldsBackTheShareThatIsToBeReordered) {
  constexpr double kShare = 0.1;
  const auto delays =
      delays_s({.delay_s = 0.1, .reordering = kShare, .reordering_delay_s = 0.3}, 3);
  const auto late = static_cast<double>(std::ranges::count(delays, 0.4));
  EXPECT_EQ(std::ranges::count(delays, 0.1) + static_cast<int>(late), kDelayed);
  const double sigma = std::sqrt(kShare * (1.0 - kShare) / kDelayed);
  EXPECT_NEAR(late / kDelayed, kShare, 5.0 * sigma);
}

TEST(RandomDelay, OfACopyIsAnother) {
  const RandomDelay delay({.jitter_s = 0.1}, 1);
  EXPECT_NE(delay.of(0, 0), delay.of(0, 1));
}

TEST(RandomDelay, KeepsItsDrawsWhateverTheOthersAre) {
  const RandomDelay jitter({.jitter_s = 0.1}, 1);
  const RandomDelay both({.jitter_s = 0.2, .reordering = 1.0, .reordering_delay_s = 1.0}, 1);
  for (std::uint64_t i = 0; i < 100; ++i) {
    EXPECT_NEAR(to_seconds(both.of(i)), 1.0 + 2.0 * to_seconds(jitter.of(i)), 1e-8);
  }
}

}  // namespace
}  // namespace fleetloc
