#pragma once

#include <ceres/sized_cost_function.h>

#include "shared/factors/parameters.hpp"

namespace fleetloc {

/// Fixes the gauge freedom of a stereo-inertial window, yaw and position of one pose, with a sigma
/// that leaves the system well scaled. It changes no estimate relative to that pose, and is never
/// marginalized. Its sigma is in every covariance of the window; it is no drift. Residual: [yaw,
/// position] / sigma. Parameters: T_odom_body (7).
class GaugeFactor final : public ceres::SizedCostFunction<4, 7> {
 public:
  static constexpr double kSigma = 1e-3;  ///< [rad, m]

  /// @param first_estimate  where the Jacobian is taken; null: at the current value
  explicit GaugeFactor(Pose T_fixed, const PoseParameters* first_estimate = nullptr);
  bool Evaluate(const double* const* parameters,
                double* residuals,
                double** jacobians) const override;

 private:
  Pose T_fixed_;
  const PoseParameters* first_estimate_;
};

/// [yaw, position in odom] with respect to the tangent of T_odom_body.
Eigen::Matrix<double, 4, 6> yaw_and_position_jacobian(const Pose& T_odom_body);

}  // namespace fleetloc
