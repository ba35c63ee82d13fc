#include "robot/vio/gauge_factor.hpp"

#include <gtest/gtest.h>

#include "test/unit/factors/factor_jacobian.hpp"

namespace fleetloc {
namespace {

const Pose kHeld = exp_se3((Vector6d() << 0.4, -0.2, 1.1, 1.0, 2.0, -1.0).finished());

TEST(GaugeFactor, JacobianIsTheNumericOne) {
  expect_numeric_jacobians(GaugeFactor(kHeld), {block_of(kHeld)}, 1e-6);
}

TEST(GaugeFactor, LeavesRollAndPitchFree) {
  for (const int axis : {0, 1}) {
    Pose tilted = kHeld;
    tilted.R = Eigen::AngleAxisd(0.2, Eigen::Vector3d::Unit(axis)) * kHeld.R;
    EXPECT_LT(residual_of(GaugeFactor(kHeld), {block_of(tilted)}).norm(), 1e-9);
  }
}

TEST(GaugeFactor, TakesItsJacobianAtTheFirstEstimate) {
  const PoseParameters first = to_parameters(kHeld);
  const Pose moved = retract(kHeld, 0.05 * Vector6d::Ones());
  const auto with = jacobians_of(GaugeFactor(kHeld, &first), {block_of(moved)});
  const auto expected = jacobians_of(GaugeFactor(kHeld), {block_of(kHeld)});
  EXPECT_LT((with[0] - expected[0]).norm(), 1e-9);
}

}  // namespace
}  // namespace fleetloc
