#include "shared/wire/fields.hpp"

#include <random>

#include <gtest/gtest.h>

#include "shared/wire/columns.hpp"
#include "test/unit/wire/samples.hpp"

namespace fleetloc {
namespace {

TEST(SquareRoot, HoldsMatricesWhoseScalesDifferByTwelveOrders) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> exponent(-3.0, 3.0);
  for (int trial = 0; trial < 200; ++trial) {
    const Matrix6d root = Matrix6d::NullaryExpr([&] { return normal(random); });
    const Vector6d scale = Vector6d::NullaryExpr([&] { return std::pow(10.0, exponent(random)); });
    const Matrix6d matrix = scale.asDiagonal() * root.transpose() * root * scale.asDiagonal();
    const SquareRoot sent = square_root_of(matrix);
    expect_near(squared(sent), matrix, 1e-6);
  }
}

TEST(SquareRoot, OfZeroIsZero) {
  EXPECT_TRUE(squared(square_root_of(Matrix6d::Zero())).isZero(0.0));
}

TEST(Gaps, ReadBackWhatWasWritten) {
  std::vector<std::uint8_t> gaps;
  std::vector<std::uint32_t> wide;
  GapWriter<std::uint32_t> writer(gaps, wide);
  const std::vector<std::int64_t> values{0, 1, 256, 511, 767, 4'294'967'295};
  for (const std::int64_t value : values) writer.push(value);
  EXPECT_EQ(gaps, (std::vector<std::uint8_t>{1, 1, 255, 255, 0, 0}));
  GapReader<std::uint32_t> reader(gaps, wide);
  for (const std::int64_t value : values) EXPECT_EQ(reader.next(), value);
}

TEST(Fields, ARotationIsNormalizedWhenReceived) {
  wire::Pose sample = to_wire(Pose{});
  sample.rotation().w(1.0 + 5e-7);
  EXPECT_TRUE(check(sample).has_value());
  EXPECT_NEAR(from_wire(sample).R.norm(), 1.0, 1e-15);
}

}  // namespace
}  // namespace fleetloc
