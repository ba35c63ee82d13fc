#include <gtest/gtest.h>

#include "shared/factors/point_factors.hpp"
#include "shared/factors/relative_pose_factor.hpp"
#include "test/unit/factors/factor_jacobian.hpp"

namespace fleetloc {
namespace {

// Full, positive definite, badly scaled.
Matrix6d some_information() {
  Matrix6d A;
  for (int i = 0; i < 36; ++i) {
    A(i / 6, i % 6) = std::sin(1.0 + 7.0 * i);
  }
  const Matrix6d scaled = Vector6d(30.0, 20.0, 50.0, 3.0, 4.0, 5.0).asDiagonal() * A;
  return scaled * scaled.transpose() + Matrix6d::Identity();
}

TEST(RelativePoseFactor, JacobiansAreTheNumericOnes) {
  const Pose T_w_a = exp_se3(Vector6d(0.5, -0.4, 1.2, 3.0, -1.0, 2.0));
  for (const double size : {0.0, 0.01, 0.7}) {
    const Pose T_a_b = exp_se3(Vector6d(0.2, 0.1, -0.3, 1.0, 0.5, -0.2));
    const Pose T_w_b = retract(T_w_a * T_a_b, size * Vector6d(1.0, -0.6, 0.4, -0.8, 0.5, 0.9));
    const RelativePoseFactor factor(T_a_b, some_information());
    expect_numeric_jacobians(factor, {block_of(T_w_a), block_of(T_w_b)});
  }
}

TEST(RelativePoseFactor, IsTheWhitenedLogarithm) {
  const Pose T_w_a = exp_se3(Vector6d(0.5, -0.4, 1.2, 3.0, -1.0, 2.0));
  const Pose T_a_b = exp_se3(Vector6d(0.2, 0.1, -0.3, 1.0, 0.5, -0.2));
  const Vector6d error = Vector6d(0.1, -0.2, 0.05, 0.3, 0.2, -0.1);
  const RelativePoseFactor factor(T_a_b, some_information());
  const Eigen::VectorXd r =
      residual_of(factor, {block_of(T_w_a), block_of(retract(T_w_a * T_a_b, error))});
  const double expected = error.dot(some_information() * error);
  EXPECT_NEAR(r.squaredNorm(), expected, 1e-9 * expected);
}

TEST(PosePriorFactor, JacobianIsTheNumericOneAndTheResidualWhitened) {
  const Pose T_prior = exp_se3(Vector6d(0.5, -0.4, 1.2, 3.0, -1.0, 2.0));
  const Vector6d error = Vector6d(0.3, -0.2, 0.4, 0.3, 0.2, -0.1);
  const PosePriorFactor factor(T_prior, some_information());
  const std::vector<double> pose = block_of(retract(T_prior, error));
  expect_numeric_jacobians(factor, {pose});
  const double expected = error.dot(some_information() * error);
  EXPECT_NEAR(residual_of(factor, {pose}).squaredNorm(), expected, 1e-9 * expected);
}

TEST(SquareRoot, KeepsNullDirectionsNull) {
  Matrix6d information = some_information();
  const Vector6d null = Vector6d(1, 2, -1, 0.5, 0.3, 1).normalized();
  const Matrix6d P = Matrix6d::Identity() - null * null.transpose();
  information = P * information * P;
  const Matrix6d S = square_root(information);
  EXPECT_LT((S.transpose() * S - information).norm(), 1e-10 * information.norm());
  EXPECT_LT((S * null).norm(), 1e-6);
}

TEST(PointToPlaneFactor, MeasuresTheDistanceAlongTheNormal) {
  const Eigen::Vector3d normal = Eigen::Vector3d(1, 2, -2) / 3.0;
  const PointToPlaneFactor factor({1, 2, 3}, normal, 0.05);
  const Eigen::Vector3d p = Eigen::Vector3d(1, 2, 3) + 0.1 * normal + Eigen::Vector3d(2, 0, 1);
  expect_numeric_jacobians(factor, {block_of(p)});
  EXPECT_NEAR(residual_of(factor, {block_of(p)})(0), 2.0, 1e-12);
}

TEST(PointToPointFactor, MeasuresTheDifference) {
  const PointToPointFactor factor({1, 2, 3}, 0.05);
  const Eigen::Vector3d p(1.1, 1.9, 3.2);
  expect_numeric_jacobians(factor, {block_of(p)});
  EXPECT_LT((residual_of(factor, {block_of(p)}) - Eigen::Vector3d(2, -2, 4)).norm(), 1e-12);
}

}  // namespace
}  // namespace fleetloc
