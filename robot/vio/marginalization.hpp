#pragma once

#include <vector>

#include <ceres/cost_function.h>

#include "shared/factors/normal_equations.hpp"

namespace fleetloc {

/// A state that a prior speaks of, and its value where the prior was linearized: a pose
/// (PoseParameters) or speed and bias (SpeedBiasParameters), told apart by their size.
struct PriorState {
  const double* values = nullptr;
  Eigen::VectorXd first;

  [[nodiscard]] int tangent_size() const;
};

/// What is known of the remaining states after others have left: e0 + J (x boxminus x_first). Its
/// Jacobian is J wherever x is (first-estimate Jacobians).
class MarginalizationPrior final : public ceres::CostFunction {
 public:
  /// @param H, g  information and gradient at the first estimates, tangents of `states` in order.
  ///        Directions with less than 1e-12 of the largest eigenvalue (after scaling H to a unit
  ///        diagonal) count as unknown.
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
NormalEquations without_leading(const NormalEquations& system, Eigen::Index count);

/// The four directions that a stereo-inertial system cannot know, at the first estimates of
/// `states`: yaw about the origin of odom, and position. Columns, in the tangents of the states.
Eigen::MatrixXd gauge_directions(const std::vector<PriorState>& states);

/// Projects `gauge` out of the system, against round-off that adds up from prior to prior.
void remove_directions(const Eigen::MatrixXd& gauge, NormalEquations& system);

}  // namespace fleetloc
