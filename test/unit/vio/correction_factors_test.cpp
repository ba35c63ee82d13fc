#include "robot/vio/correction_factors.hpp"

#include <random>

#include <gtest/gtest.h>

#include "test/unit/factors/factor_jacobian.hpp"

namespace fleetloc {
namespace {

const Pose kFrom = exp_se3((Vector6d() << 0.4, -0.2, 1.1, 1.0, 2.0, -1.0).finished());
const Pose kTo = exp_se3((Vector6d() << 0.3, -0.5, 1.4, 1.2, 1.7, -0.8).finished());
const Pose kFirst = retract(kFrom, 0.05 * Vector6d::Ones());
const Eigen::Vector3d kCorrectedPoint(3.0, -1.0, 2.0);

template <typename Matrix>
Matrix some_information() {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const Matrix A = Matrix::NullaryExpr([&] { return 10.0 * normal(random); });
  return A * A.transpose();
}

Correction::Landmark landmark() {
  return {LandmarkId{1},
          inverse(kFrom) * kCorrectedPoint + Eigen::Vector3d(0.1, -0.2, 0.05),
          some_information<Eigen::Matrix3d>()};
}

Correction::RelativePose relative_pose() {
  return {KeyframeId{1},
          KeyframeId{2},
          retract(inverse(kFrom) * kTo, 0.03 * Vector6d::Ones()),
          some_information<Matrix6d>()};
}

// How a pose, and a point, move with yaw about the origin of odom and with position.
Eigen::Matrix<double, 6, 4> gauge(const Pose& T) {
  const Eigen::Matrix3d R = T.R.toRotationMatrix().transpose();
  Eigen::Matrix<double, 6, 4> N = Eigen::Matrix<double, 6, 4>::Zero();
  N.topLeftCorner<3, 1>() = R.col(2);
  N.bottomLeftCorner<3, 1>() = R * Eigen::Vector3d::UnitZ().cross(T.p);
  N.bottomRightCorner<3, 3>() = R;
  return N;
}
Eigen::Matrix<double, 3, 4> gauge(const Eigen::Vector3d& p) {
  Eigen::Matrix<double, 3, 4> N;
  N << Eigen::Vector3d::UnitZ().cross(p), Eigen::Matrix3d::Identity();
  return N;
}

TEST(LandmarkCorrectionFactor, JacobiansAreTheNumericOnes) {
  expect_numeric_jacobians(LandmarkCorrectionFactor(landmark()),
                           {block_of(kFrom), block_of(kCorrectedPoint)});
}

TEST(LandmarkCorrectionFactor, IsTheWhitenedDistanceInTheAnchor) {
  const Correction::Landmark correction = landmark();
  const Eigen::Vector3d e = inverse(kFrom) * kCorrectedPoint - correction.p_anchor;
  const double squared = residual_of(LandmarkCorrectionFactor(correction),
                                     {block_of(kFrom), block_of(kCorrectedPoint)})
                             .squaredNorm();
  EXPECT_NEAR(squared, e.dot(correction.information * e), 1e-9 * squared);
}

TEST(LandmarkCorrectionFactor, KnowsNothingOfYawAndPositionAtTheFirstEstimate) {
  const PoseParameters first = to_parameters(kFirst);
  const LandmarkCorrectionFactor factor(landmark(), &first);
  const auto J = jacobians_of(factor, {block_of(kFrom), block_of(kCorrectedPoint)});
  const Eigen::MatrixXd moved = J[0].leftCols<6>() * gauge(kFirst) + J[1] * gauge(kCorrectedPoint);
  EXPECT_LT(moved.norm(), 1e-12 * J[0].norm());
  const auto at_first = jacobians_of(LandmarkCorrectionFactor(landmark()),
                                     {block_of(kFirst), block_of(kCorrectedPoint)});
  EXPECT_LT((J[0] - at_first[0]).norm() + (J[1] - at_first[1]).norm(), 1e-12 * J[0].norm());
  EXPECT_EQ(residual_of(factor, {block_of(kFrom), block_of(kCorrectedPoint)}),
            residual_of(LandmarkCorrectionFactor(landmark()),
                        {block_of(kFrom), block_of(kCorrectedPoint)}));
}

TEST(PoseCorrectionFactor, JacobiansAreTheNumericOnes) {
  expect_numeric_jacobians(PoseCorrectionFactor(relative_pose()), {block_of(kFrom), block_of(kTo)});
}

TEST(PoseCorrectionFactor, KnowsNothingOfYawAndPositionAtTheFirstEstimates) {
  const PoseParameters first = to_parameters(kFirst);
  const PoseCorrectionFactor factor(relative_pose(), &first, nullptr);
  const auto J = jacobians_of(factor, {block_of(kFrom), block_of(kTo)});
  const Eigen::MatrixXd moved =
      J[0].leftCols<6>() * gauge(kFirst) + J[1].leftCols<6>() * gauge(kTo);
  EXPECT_LT(moved.norm(), 1e-12 * J[0].norm());
  EXPECT_EQ(residual_of(factor, {block_of(kFrom), block_of(kTo)}),
            residual_of(PoseCorrectionFactor(relative_pose()), {block_of(kFrom), block_of(kTo)}));
}

TEST(Corrections, WithoutInformationSayNothing) {
  Correction::Landmark point = landmark();
  point.information.setZero();
  Correction::RelativePose pose = relative_pose();
  pose.information.setZero();
  EXPECT_TRUE(
      residual_of(LandmarkCorrectionFactor(point), {block_of(kFrom), block_of(kCorrectedPoint)})
          .isZero(0.0));
  EXPECT_TRUE(
      residual_of(PoseCorrectionFactor(pose), {block_of(kFrom), block_of(kTo)}).isZero(0.0));
}

}  // namespace
}  // namespace fleetloc
