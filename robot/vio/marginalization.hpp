#pragma once

#include <vector>

#include <ceres/cost_function.h>

#include "shared/factors/normal_equations.hpp"

namespace fleetloc {

/// A state of a prior and its linearization point: a pose (PoseParameters) or speed and bias
/// (SpeedBiasParameters), told apart by their size.
struct PriorState {
  const double* values = nullptr;
  Eigen::VectorXd first;

  [[nodiscard]] int tangent_size() const;
};

/// Prior on the remaining states after marginalization: e0 + J (x boxminus x_first). Its Jacobian
/// is J at any x (first-estimate Jacobians).
class MarginalizationPrior final : public ceres::CostFunction {
 public:
  /// @param H, g  information and gradient at the first estimates, tangents of `states` in order.
  ///        Directions with less than 1e-12 of the largest eigenvalue (after scaling H to a unit
  ///        diagonal) count as unobserved.
  MarginalizationPrior(std::vector<PriorState> states,
                       const Eigen::MatrixXd& H,
                       const Eigen::VectorXd& g);

  bool Evaluate(const double* const* parameters,
                double* residuals,
                double** jacobians) const override;

  [[nodiscard]] const std::vector<PriorState>& states() const { return states_; }
  [[nodiscard]] const Eigen::MatrixXd& jacobian() const { return J_; }

 private:
  std::vector<PriorState> states_;
  Eigen::MatrixXd J_;
  Eigen::VectorXd e0_;
};

/// x boxminus first, in the tangent.
Eigen::VectorXd difference(const PriorState& first, const double* x);

/// Schur complement that removes the first `count` unknowns of the system.
NormalEquations marginalize_leading(const NormalEquations& system, Eigen::Index count);

/// The four unobservable directions of a stereo-inertial system, at the first estimates of
/// `states`: yaw about the origin of odom, and position. Columns, in the tangents of the states.
Eigen::MatrixXd gauge_directions(const std::vector<PriorState>& states);

/// Projects `gauge` out of the system, against round-off that adds up from prior to prior.
void project_out(const Eigen::MatrixXd& gauge, NormalEquations& system);

}  // namespace fleetloc
