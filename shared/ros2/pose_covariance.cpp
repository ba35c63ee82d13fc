#include "shared/ros2/pose_covariance.hpp"

#include <algorithm>

#include <Eigen/Eigenvalues>

#include "shared/ros2/ros2_fields.hpp"

namespace fleetloc {
namespace {

using RowMajor = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

/// d(x y z, rotation about fixed axes) / d(xi)
Matrix6d J_ros2_xi(const Eigen::Quaterniond& R_a_b) {
  Matrix6d J = Matrix6d::Zero();
  J.topRightCorner<3, 3>() = R_a_b.toRotationMatrix();
  J.bottomLeftCorner<3, 3>() = R_a_b.toRotationMatrix();
  return J;
}

Ros2Covariance row_major(const Matrix6d& matrix) {
  Ros2Covariance values{};
  Eigen::Map<RowMajor>(values.data()) = matrix;
  return values;
}

}  // namespace

Ros2Covariance to_ros2_covariance(const Matrix6d& covariance, const Eigen::Quaterniond& R_a_b) {
  const Matrix6d J = J_ros2_xi(R_a_b);
  return row_major(J * covariance * J.transpose());
}

Matrix6d from_ros2_covariance(std::span<const double, 36> covariance,
                              const Eigen::Quaterniond& R_a_b) {
  const Matrix6d J = J_ros2_xi(R_a_b);  // orthogonal
  const Matrix6d ros2 = Eigen::Map<const RowMajor>(covariance.data());
  const Matrix6d ours = J.transpose() * ros2 * J;
  return 0.5 * (ours + ours.transpose());
}

Ros2Covariance to_ros2_twist_covariance(const Matrix6d& covariance) {
  return to_ros2_covariance(covariance, Eigen::Quaterniond::Identity());
}

Ros2Validity check_covariance(std::span<const double, 36> covariance) {
  constexpr double kMax = 1e12;  // "unknown" is often said by a large number
  constexpr double kRounding = 1e-6;
  if (const Ros2Validity valid = check_finite(covariance); !valid) return valid;
  const Matrix6d matrix = Eigen::Map<const RowMajor>(covariance.data());
  const double scale = matrix.cwiseAbs().maxCoeff();
  if (scale > kMax) return unexpected(Ros2Refusal::kOutOfRange);
  const bool is_symmetric =
      (matrix - matrix.transpose()).cwiseAbs().maxCoeff() <= kRounding * scale;
  if (!is_symmetric) return unexpected(Ros2Refusal::kNotACovariance);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(matrix, Eigen::EigenvaluesOnly);
  if (eigen.eigenvalues().minCoeff() < -kRounding * scale) {
    return unexpected(Ros2Refusal::kNotACovariance);
  }
  return {};
}

}  // namespace fleetloc
