#pragma once

#include <ceres/sized_cost_function.h>

#include "shared/factors/parameters.hpp"

namespace fleetloc {

/// Virtual odometry (paper, eq. 10), whitened: sqrt_information * Log(T_a_b^-1 * T_w_a^-1 * T_w_b).
/// Parameters: T_world_a (7), T_world_b (7).
class RelativePoseFactor final : public ceres::SizedCostFunction<6, 7, 7> {
 public:
  /// @param information  positive semi-definite, of the error as stated above
  RelativePoseFactor(const Pose& T_a_b, const Matrix6d& information);
  bool Evaluate(const double* const* parameters,
                double* residuals,
                double** jacobians) const override;

 private:
  Pose T_b_a_;
  Matrix6d sqrt_information_;
};

/// Pose prior, whitened: sqrt_information * Log(T_prior^-1 * T). Parameters: T_world_body (7).
class PosePriorFactor final : public ceres::SizedCostFunction<6, 7> {
 public:
  PosePriorFactor(const Pose& T_prior, const Matrix6d& information);
  bool Evaluate(const double* const* parameters,
                double* residuals,
                double** jacobians) const override;

 private:
  Pose T_prior_inverse_;
  Matrix6d sqrt_information_;
};

/// S with S^T S = information, for positive semi-definite matrices; eigenvalues below
/// `relative_threshold` times the largest count as zero.
Matrix6d square_root(const Matrix6d& information, double relative_threshold = 1e-12);

}  // namespace fleetloc
