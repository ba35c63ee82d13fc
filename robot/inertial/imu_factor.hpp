#pragma once

#include <array>

#include <ceres/sized_cost_function.h>

#include "robot/inertial/preintegration.hpp"
#include "shared/factors/parameters.hpp"

namespace fleetloc {

/// Velocity and biases as a Ceres parameter block: [v_odom m/s, gyroscope rad/s, accelerometer
/// m/s^2].
using SpeedBiasParameters = std::array<double, 9>;

SpeedBiasParameters to_speed_bias(const NavState& state);
NavState nav_state_from(const double* pose, const double* speed_bias);

/// Where the Jacobians of a factor on one state are taken (first-estimate Jacobians); null: at the
/// current value. Must outlive the factor.
struct FirstEstimate {
  const PoseParameters* pose = nullptr;
  const SpeedBiasParameters* speed_bias = nullptr;
};

/// Preintegration error (paper, eq. 2) and bias random walk (eq. 3), whitened, 15 residuals:
/// [rotation, position, velocity, gyroscope bias, accelerometer bias]. Parameters: T_odom_body (7)
/// and speed-bias (9) of the first state, then of the second.
class ImuFactor final : public ceres::SizedCostFunction<15, 7, 9, 7, 9> {
 public:
  explicit ImuFactor(Preintegration preintegration,
                     FirstEstimate first = {},
                     FirstEstimate second = {});
  bool Evaluate(const double* const* parameters,
                double* residuals,
                double** jacobians) const override;
  [[nodiscard]] const Preintegration& preintegration() const;

 private:
  Preintegration preintegration_;
  FirstEstimate first_;
  FirstEstimate second_;
  Matrix15d whitening_;  ///< W with W^T W = covariance^-1; lower triangular
};

/// The unwhitened error of two states (Forster et al., 2017, eq. 45, and the bias random walk) and
/// its Jacobians with respect to the tangent of NavState (15 each).
struct ImuError {
  Vector15d error;
  Matrix15d J_first;
  Matrix15d J_second;
};
ImuError imu_error(const Preintegration& preintegration,
                   const NavState& first,
                   const NavState& second);

/// Covariance of that error: the preintegration's, the random walk of the biases, and their
/// correlation, since the deltas are corrected for the bias of the first state only.
Matrix15d imu_error_covariance(const Preintegration& preintegration);

}  // namespace fleetloc
