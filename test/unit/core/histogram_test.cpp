#include "shared/core/histogram.hpp"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "shared/core/percentile.hpp"
#include "shared/core/uniform.hpp"

namespace fleetloc {
namespace {

TEST(Histogram, HasThePercentilesOfItsValuesToHalfAPercent) {
  std::mt19937_64 random(7);
  Histogram histogram;
  std::vector<double> values;
  for (int i = 0; i < 20000; ++i) {
    values.push_back(std::exp(4.0 * uniform(random)));  // 1 to 55 ms
    histogram.add(values.back());
  }
  for (const double share : {0.0, 0.01, 0.5, 0.99, 1.0}) {
    EXPECT_NEAR(histogram.percentile(share).value() / percentile(values, share).value(), 1.0, 0.006)
        << share;
  }
  EXPECT_EQ(histogram.count(), values.size());
}

TEST(Histogram, OfOneValueIsThatValue) {
  Histogram histogram;
  histogram.add(3.0);
  EXPECT_EQ(histogram.percentile(0.0), 3.0);
  EXPECT_EQ(histogram.percentile(1.0), 3.0);
  EXPECT_EQ(histogram.sum(), 3.0);
}

TEST(Histogram, OfNothingHasNoPercentiles) {
  Histogram histogram;
  histogram.add(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(histogram.percentile(0.5), std::nullopt);
  EXPECT_EQ(histogram.count(), 0U);
}

TEST(Histogram, KeepsWhatIsOutsideOfItsRangeAtItsEnds) {
  Histogram histogram;
  for (const double value : {-1.0, 0.0, 1e8, 1e9}) histogram.add(value);
  EXPECT_EQ(histogram.percentile(0.0), -1.0);
  EXPECT_LT(histogram.percentile(0.3).value(), 2e-4);
  EXPECT_GT(histogram.percentile(0.7).value(), 9e4);
  EXPECT_EQ(histogram.percentile(1.0), 1e9);
}

}  // namespace
}  // namespace fleetloc
