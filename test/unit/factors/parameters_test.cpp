#include "shared/factors/parameters.hpp"

#include <gtest/gtest.h>

namespace fleetloc {
namespace {

Pose some_pose() {
  return exp_se3((Vector6d() << 0.3, -1.2, 0.7, 1.0, -2.0, 3.0).finished());
}

TEST(PoseParameters, RoundTrip) {
  const Pose T = some_pose();
  const PoseParameters parameters = to_parameters(T);
  EXPECT_LT(local_coordinates(T, pose_from(parameters.data())).norm(), 1e-14);
}

TEST(PoseManifold, PlusRetractsAndMinusInvertsIt) {
  const PoseManifold manifold;
  const PoseParameters x = to_parameters(some_pose());
  const Vector6d delta = (Vector6d() << 0.1, 0.2, -0.3, 0.4, -0.5, 0.6).finished();
  PoseParameters y;
  ASSERT_TRUE(manifold.Plus(x.data(), delta.data(), y.data()));
  EXPECT_LT(local_coordinates(retract(some_pose(), delta), pose_from(y.data())).norm(), 1e-14);
  Vector6d back;
  ASSERT_TRUE(manifold.Minus(y.data(), x.data(), back.data()));
  EXPECT_LT((back - delta).norm(), 1e-13);
}

TEST(PoseManifold, JacobiansCutTheSeventhColumn) {
  const PoseManifold manifold;
  const PoseParameters x = to_parameters(some_pose());
  Eigen::Matrix<double, 7, 6, Eigen::RowMajor> plus;
  Eigen::Matrix<double, 6, 7, Eigen::RowMajor> minus;
  ASSERT_TRUE(manifold.PlusJacobian(x.data(), plus.data()));
  ASSERT_TRUE(manifold.MinusJacobian(x.data(), minus.data()));
  EXPECT_EQ(plus, (Eigen::Matrix<double, 7, 6>::Identity()));
  EXPECT_EQ(minus, (Eigen::Matrix<double, 6, 7>::Identity()));
}

}  // namespace
}  // namespace fleetloc
