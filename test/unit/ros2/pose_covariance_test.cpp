#include "shared/ros2/pose_covariance.hpp"

#include <cmath>

#include "test/unit/ros2/samples.hpp"

namespace fleetloc {
namespace {

using RowMajor = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

Matrix6d matrix(const Ros2Covariance& covariance) {
  return Eigen::Map<const RowMajor>(covariance.data());
}

/// What ROS 2 means by T * Exp(xi): where the position and the rotation about the fixed axes of a
/// differ from those of T.
Vector6d ros2_difference(const Pose& T_a_b, const Vector6d& xi) {
  const Pose moved = retract(T_a_b, xi);
  Vector6d difference;
  difference << moved.p - T_a_b.p, log_so3(moved.R * T_a_b.R.conjugate());
  return difference;
}

Matrix6d numeric_jacobian(const Pose& T_a_b) {
  constexpr double kStep = 1e-6;
  Matrix6d J;
  for (int i = 0; i < 6; ++i) {
    const Vector6d xi = kStep * Vector6d::Unit(i);
    J.col(i) = (ros2_difference(T_a_b, xi) - ros2_difference(T_a_b, -xi)) / (2.0 * kStep);
  }
  return J;
}

TEST(Ros2PoseCovariance, IsThatOfNumericDifferences) {
  const Matrix6d J = numeric_jacobian(some_pose());
  const Matrix6d expected = J * some_covariance() * J.transpose();
  const Matrix6d actual = matrix(to_ros2_covariance(some_covariance(), some_pose().R));
  EXPECT_LT((actual - expected).cwiseAbs().maxCoeff(), 1e-8 * expected.cwiseAbs().maxCoeff());
}

TEST(Ros2PoseCovariance, RoundTripPreservesEveryEntry) {
  const Eigen::Quaterniond R = some_pose().R;
  const Matrix6d back = from_ros2_covariance(to_ros2_covariance(some_covariance(), R), R);
  EXPECT_LT((back - some_covariance()).cwiseAbs().maxCoeff(), 1e-15);
}

TEST(Ros2PoseCovariance, HasPositionBeforeRotation) {
  Matrix6d ours = Matrix6d::Zero();
  ours.diagonal() << 1.0, 2.0, 3.0, 4.0, 5.0, 6.0;
  Vector6d expected;
  expected << 4.0, 5.0, 6.0, 1.0, 2.0, 3.0;
  const auto identity = Eigen::Quaterniond::Identity();
  EXPECT_EQ(matrix(to_ros2_covariance(ours, identity)).diagonal(), expected);
  EXPECT_EQ(matrix(to_ros2_twist_covariance(ours)).diagonal(), expected);
}

TEST(Ros2PoseCovariance, IsStatedInTheAxesOfTheHeadersFrame) {
  Matrix6d forwards_of_the_body = Matrix6d::Zero();
  forwards_of_the_body(3, 3) = 4.0;
  const Eigen::Quaterniond quarter_turn = exp_so3({0.0, 0.0, std::acos(-1.0) / 2.0});
  const Matrix6d ros2 = matrix(to_ros2_covariance(forwards_of_the_body, quarter_turn));
  EXPECT_NEAR(ros2(0, 0), 0.0, 1e-12);
  EXPECT_NEAR(ros2(1, 1), 4.0, 1e-12);
}

}  // namespace
}  // namespace fleetloc
