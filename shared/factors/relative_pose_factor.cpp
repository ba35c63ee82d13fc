#include "shared/factors/relative_pose_factor.hpp"

#include <Eigen/Eigenvalues>

namespace fleetloc {
namespace {

void write_jacobian(const Matrix6d& J, double* jacobian) {
  RowMajorMap<6, 7> target(jacobian);
  target.leftCols<6>() = J;
  target.col(6).setZero();
}

}  // namespace

RelativePoseFactor::RelativePoseFactor(const Pose& T_a_b, const Matrix6d& information)
    : T_b_a_(inverse(T_a_b)), sqrt_information_(square_root(information)) {}

bool RelativePoseFactor::Evaluate(const double* const* parameters,
                                  double* residuals,
                                  double** jacobians) const {
  const Pose T_a_b = inverse(pose_from(parameters[0])) * pose_from(parameters[1]);
  const Vector6d error = log_se3(T_b_a_ * T_a_b);
  Eigen::Map<Vector6d>{residuals}.noalias() = sqrt_information_ * error;
  if (jacobians == nullptr) {
    return true;
  }
  const Matrix6d J_b = sqrt_information_ * right_jacobian_inverse_se3(error);
  if (jacobians[0] != nullptr) {
    write_jacobian(-J_b * adjoint(inverse(T_a_b)), jacobians[0]);
  }
  if (jacobians[1] != nullptr) {
    write_jacobian(J_b, jacobians[1]);
  }
  return true;
}

PosePriorFactor::PosePriorFactor(const Pose& T_prior, const Matrix6d& information)
    : T_prior_inverse_(inverse(T_prior)), sqrt_information_(square_root(information)) {}

bool PosePriorFactor::Evaluate(const double* const* parameters,
                               double* residuals,
                               double** jacobians) const {
  const Vector6d error = log_se3(T_prior_inverse_ * pose_from(parameters[0]));
  Eigen::Map<Vector6d>{residuals}.noalias() = sqrt_information_ * error;
  if (jacobians != nullptr && jacobians[0] != nullptr) {
    write_jacobian(sqrt_information_ * right_jacobian_inverse_se3(error), jacobians[0]);
  }
  return true;
}

Matrix6d square_root(const Matrix6d& information, double relative_threshold) {
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(information);
  const double min_eigenvalue = relative_threshold * eigen.eigenvalues()(5);
  const Vector6d roots = eigen.eigenvalues().unaryExpr(
      [min_eigenvalue](double value) { return value > min_eigenvalue ? std::sqrt(value) : 0.0; });
  return roots.asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace fleetloc
