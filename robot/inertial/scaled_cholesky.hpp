#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace fleetloc {

/// Cholesky factorization of a symmetric positive definite matrix whose entries differ by many
/// orders of magnitude (radians beside metres per second squared): it is scaled to a unit diagonal
/// first.
class ScaledCholesky {
 public:
  explicit ScaledCholesky(const Eigen::MatrixXd& matrix) {
    if (!matrix.allFinite() || !(matrix.diagonal().array() > 0.0).all()) return;
    scale_ = matrix.diagonal().cwiseSqrt().cwiseInverse();
    factor_.compute(scale_.asDiagonal() * matrix * scale_.asDiagonal());
    if (factor_.info() != Eigen::Success) return;
    const double pivot = factor_.matrixLLT().diagonal().cwiseAbs2().minCoeff();
    regular_ = pivot > kMinPivot;
  }

  /// Positive definite; otherwise no other function may be called.
  [[nodiscard]] bool regular() const { return regular_; }

  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const {
    return scale_.asDiagonal() * factor_.solve(scale_.asDiagonal() * right);
  }

  /// Symmetric.
  [[nodiscard]] Eigen::MatrixXd inverse() const {
    const Eigen::MatrixXd result = solve(Eigen::MatrixXd::Identity(scale_.size(), scale_.size()));
    return 0.5 * (result + result.transpose());
  }

  [[nodiscard]] double log_determinant() const {
    return 2.0 * (factor_.matrixLLT().diagonal().array().log().sum() - scale_.array().log().sum());
  }

 private:
  // Smallest pivot of a matrix with unit diagonal at which it still counts as regular.
  static constexpr double kMinPivot = 1e-13;

  Eigen::VectorXd scale_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
  bool regular_ = false;
};

}  // namespace fleetloc
