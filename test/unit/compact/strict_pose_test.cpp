#include "shared/compact/strict_pose.hpp"

#include <cmath>
#include <limits>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "shared/compact/compact_submap.hpp"
#include "shared/compact/turn.hpp"

namespace fleetloc {
namespace {

Eigen::Quaterniond some_rotation(std::mt19937& random) {
  std::normal_distribution<double> number;
  return Eigen::Quaterniond(number(random), number(random), number(random), number(random))
      .normalized();
}

StrictRotation strict(const Eigen::Quaterniond& q) {
  return {q.w(), q.x(), q.y(), q.z()};
}

double angle_between(const StrictRotation& a, const Eigen::Quaterniond& b) {
  return Eigen::Quaterniond(a[0], a[1], a[2], a[3]).angularDistance(b);
}

TEST(StrictPose, AgreesWithEigen) {
  std::mt19937 random(1);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Quaterniond a = some_rotation(random);
    const Eigen::Quaterniond b = some_rotation(random);
    EXPECT_LT(angle_between(product(strict(a), strict(b)), a * b), 1e-7);
    EXPECT_LT(angle_between(product(conjugate(strict(a)), strict(b)), a.conjugate() * b), 1e-7);
    const Eigen::Vector3d v = b.vec();
    const StrictVector rotated = product(matrix_of(strict(a)), StrictVector{v.x(), v.y(), v.z()});
    const StrictVector back = transposed_product(matrix_of(strict(a)), rotated);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(rotated[axis], (a * v)[static_cast<Eigen::Index>(axis)], 1e-14);
      EXPECT_NEAR(back[axis], v[static_cast<Eigen::Index>(axis)], 1e-14);
    }
  }
}

TEST(Turn, IsARotationToHalfAUnitOfEachComponent) {
  std::mt19937 random(2);
  for (const std::int32_t units : {4096, 1 << 16}) {
    for (int i = 0; i < 1000; ++i) {
      const Eigen::Quaterniond q = some_rotation(random);
      const Turn turn = turn_of(strict(q), units);
      // Three components, half a unit each; the fourth, at least a half, moves by as much again.
      EXPECT_LT(angle_between(rotation_of(turn, units), q), 2.0 * std::sqrt(3.0) / units + 1e-7);
    }
  }
}

TEST(SigmaCode, IsWithinAnEighthOfAnOctave) {
  for (double sigma = 1e-7; sigma < 10.0; sigma *= 1.07) {
    EXPECT_NEAR(std::log2(SigmaCode::sigma(SigmaCode::nearest(sigma)) / sigma), 0.0, 0.1251);
  }
  EXPECT_EQ(SigmaCode::nearest(1e9), 1);
  EXPECT_EQ(SigmaCode::nearest(0.0), SigmaCode::kMax);
}

TEST(Rounded, ClampsEverything) {
  EXPECT_EQ(rounded(2.5, 0, 10), 3);
  EXPECT_EQ(rounded(-2.5, -10, 10), -2);
  EXPECT_EQ(rounded(1e300, -10, 10), 10);
  EXPECT_EQ(rounded(-1e300, -10, 10), -10);
  EXPECT_EQ(rounded(std::numeric_limits<double>::quiet_NaN(), -10, 10), -10);
}

}  // namespace
}  // namespace fleetloc
