#include "shared/coding/integer_model.hpp"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "shared/coding/range_decoder.hpp"
#include "shared/coding/range_encoder.hpp"

namespace fleetloc {
namespace {

TEST(IntegerModel, RoundTripPreservesNumbersOfEverySize) {
  std::vector<std::uint32_t> values{0, 1, 2, 3, std::numeric_limits<std::uint32_t>::max()};
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) values.push_back(static_cast<std::uint32_t>(random()) >> (i % 32));
  RangeEncoder encoder;
  IntegerModel model;
  for (const std::uint32_t value : values) model.code(encoder, value);
  const auto bytes = encoder.finish();
  RangeDecoder decoder(bytes);
  IntegerModel again;
  for (const std::uint32_t value : values) ASSERT_EQ(again.code(decoder, 0), value);
}

TEST(IntegerModel, RoundTripPreservesSigns) {
  std::vector<std::int32_t> values{0, -1, 1, 2'147'483'646, -2'147'483'646};
  std::mt19937 random(2);
  std::normal_distribution<double> number(0.0, 30.0);
  for (int i = 0; i < 2000; ++i) values.push_back(static_cast<std::int32_t>(number(random)));
  RangeEncoder encoder;
  IntegerModel model;
  for (const std::int32_t value : values) model.code_signed(encoder, value);
  const auto bytes = encoder.finish();
  RangeDecoder decoder(bytes);
  IntegerModel again;
  for (const std::int32_t value : values) ASSERT_EQ(again.code_signed(decoder, 0), value);
}

// Differential entropy of a Gaussian with the steps' width of one.
TEST(IntegerModel, LearnsTheShapeOfAGaussian) {
  constexpr double kSigma = 6.0;
  std::mt19937 random(3);
  std::normal_distribution<double> number(0.0, kSigma);
  RangeEncoder encoder;
  IntegerModel model;
  constexpr int kCount = 20'000;
  for (int i = 0; i < kCount; ++i) {
    model.code_signed(encoder, static_cast<std::int32_t>(std::lround(number(random))));
  }
  const double bits = 8.0 * static_cast<double>(encoder.finish().size()) / kCount;
  const double entropy = 0.5 * std::log2(2.0 * M_PI * M_E * kSigma * kSigma);
  EXPECT_LT(bits, 1.05 * entropy);
}

TEST(IntegerModel, TakesAnyBytes) {
  std::mt19937 random(4);
  for (int round = 0; round < 200; ++round) {
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(round));
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
    RangeDecoder decoder(bytes);
    IntegerModel model;
    for (int i = 0; i < 100; ++i) model.code_signed(decoder, 0);
  }
}

}  // namespace
}  // namespace fleetloc
