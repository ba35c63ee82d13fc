#include "shared/trajectory/trajectory.hpp"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

using std::chrono::milliseconds;

Timestamp at(int ms) {
  return Timestamp(milliseconds(ms));
}

/// Constant velocity and turning rate, which interpolation reproduces exactly.
Pose screw(double t_s) {
  return {.R = exp_so3(t_s * Eigen::Vector3d(0.3, -2.0, 1.0)),
          .p = Eigen::Vector3d(1.0, 2.0, 3.0) + t_s * Eigen::Vector3d(-1.0, 0.5, 0.25)};
}

Trajectory sampled(int interval_ms) {
  Trajectory trajectory;
  for (int ms = 0; ms <= 1000; ms += interval_ms) {
    trajectory.push_back({.stamp = at(ms), .T_ref_body = screw(0.001 * ms)});
  }
  return trajectory;
}

TEST(Interpolation, IsExactAtConstantVelocityAndTurningRate) {
  const Trajectory trajectory = sampled(100);
  for (const int ms : {0, 1, 50, 99, 100, 733, 1000}) {
    const auto T = interpolate(trajectory, at(ms), milliseconds(100));
    ASSERT_TRUE(T) << ms;
    EXPECT_LT(local_coordinates(*T, screw(0.001 * ms)).norm(), 1e-12) << ms;
  }
}

TEST(Interpolation, TakesTheShortArcWhateverTheSignOfTheQuaternion) {
  Trajectory trajectory = sampled(100);
  trajectory[1].T_ref_body.R.coeffs() *= -1.0;
  const auto T = interpolate(trajectory, at(150), milliseconds(100));
  EXPECT_LT(local_coordinates(*T, screw(0.15)).norm(), 1e-12);
}

TEST(Interpolation, RefusesGapsAndWhatLiesOutside) {
  const Trajectory trajectory = sampled(100);
  EXPECT_FALSE(interpolate(trajectory, at(150), milliseconds(99)));
  EXPECT_TRUE(interpolate(trajectory, at(100), milliseconds(99)));
  EXPECT_FALSE(interpolate(trajectory, at(-1), milliseconds(100)));
  EXPECT_FALSE(interpolate(trajectory, at(1001), milliseconds(100)));
  EXPECT_FALSE(interpolate({}, at(0), milliseconds(100)));
}

TEST(Association, PairsWhatHasGroundTruth) {
  const Trajectory estimate = {{.stamp = at(-5), .T_ref_body = {}},
                               {.stamp = at(250), .T_ref_body = screw(7.0)},
                               {.stamp = at(2000), .T_ref_body = {}}};
  const auto pairs = associate(sampled(100), estimate, milliseconds(100));
  ASSERT_EQ(pairs.size(), 1U);
  EXPECT_EQ(pairs[0].stamp, at(250));
  EXPECT_LT(local_coordinates(pairs[0].T_truth_body, screw(0.25)).norm(), 1e-12);
  EXPECT_LT(local_coordinates(pairs[0].T_estimate_body, screw(7.0)).norm(), 1e-12);
}

TEST(Coverage, IsTheShareOfStampsWithAPoseNearby) {
  const Trajectory estimate = {{.stamp = at(100), .T_ref_body = {}},
                               {.stamp = at(200), .T_ref_body = {}}};
  const std::array stamps = {at(90), at(101), at(198), at(203)};
  EXPECT_EQ(coverage(stamps, estimate, milliseconds(2)), 0.5);
  EXPECT_EQ(coverage(stamps, {}, milliseconds(2)), 0.0);
  EXPECT_EQ(coverage({}, estimate, milliseconds(2)), 0.0);
}

}  // namespace
}  // namespace fleetloc
