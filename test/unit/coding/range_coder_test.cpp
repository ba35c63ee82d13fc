#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "shared/coding/range_decoder.hpp"
#include "shared/coding/range_encoder.hpp"

namespace fleetloc {
namespace {

std::vector<bool> some_bits(double share, std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::bernoulli_distribution bit(share);
  std::vector<bool> bits(count);
  for (std::size_t i = 0; i < count; ++i) bits[i] = bit(random);
  return bits;
}

std::vector<std::uint8_t> encoded(const std::vector<bool>& bits) {
  RangeEncoder encoder;
  BitModel model;
  for (const bool bit : bits) encoder.code(model, bit);
  return encoder.finish();
}

TEST(RangeCoder, RoundTripPreservesEveryBit) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    const auto bits = some_bits(0.01 * (seed % 101), seed * 7, seed);
    const auto bytes = encoded(bits);
    RangeDecoder decoder(bytes);
    BitModel model;
    for (std::size_t i = 0; i < bits.size(); ++i) {
      ASSERT_EQ(decoder.code(model), bits[i]) << "seed " << seed << " bit " << i;
    }
    EXPECT_FALSE(decoder.is_overrun());
  }
}

// Ones in a row of a probability near one push carries through many bytes.
TEST(RangeCoder, CarriesThroughBytesOfOnes) {
  std::vector<bool> bits(5000, true);
  for (std::size_t i = 0; i < bits.size(); i += 997) bits[i] = false;
  const auto bytes = encoded(bits);
  RangeDecoder decoder(bytes);
  BitModel model;
  for (std::size_t i = 0; i < bits.size(); ++i) ASSERT_EQ(decoder.code(model), bits[i]) << i;
}

TEST(RangeCoder, RawBitsAndModelledOnesMix) {
  std::mt19937 random(5);
  std::vector<std::uint32_t> values(300);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = static_cast<std::uint32_t>(random()) >> (i % 32);
  RangeEncoder encoder;
  BitModel model;
  for (std::size_t i = 0; i < values.size(); ++i) {
    encoder.code(model, values[i] % 3 == 0);
    encoder.code_raw(values[i], 32 - static_cast<int>(i % 32));
  }
  const auto bytes = encoder.finish();
  RangeDecoder decoder(bytes);
  BitModel again;
  for (std::size_t i = 0; i < values.size(); ++i) {
    ASSERT_EQ(decoder.code(again), values[i] % 3 == 0);
    ASSERT_EQ(decoder.code_raw(0, 32 - static_cast<int>(i % 32)), values[i]);
  }
}

// Shannon's bound for bits whose probability must be learnt, and some per cent for learning it.
TEST(RangeCoder, CostsLittleMoreThanTheEntropy) {
  for (const double share : {0.5, 0.2, 0.05}) {
    const double entropy = -share * std::log2(share) - (1 - share) * std::log2(1 - share);
    const auto bytes = encoded(some_bits(share, 40'000, 3));
    EXPECT_LT(8.0 * static_cast<double>(bytes.size()), 1.05 * entropy * 40'000) << share;
  }
}

TEST(RangeCoder, NothingTakesNoBytes) {
  EXPECT_TRUE(RangeEncoder().finish().empty());
}

TEST(RangeDecoder, SaysWhenMoreIsReadThanWasWritten) {
  const auto bytes = encoded(some_bits(0.5, 80, 1));
  RangeDecoder decoder(bytes);
  decoder.code_raw(0, 32);
  EXPECT_FALSE(decoder.is_overrun());
  for (int i = 0; i < 8; ++i) decoder.code_raw(0, 32);
  EXPECT_TRUE(decoder.is_overrun());
}

}  // namespace
}  // namespace fleetloc
