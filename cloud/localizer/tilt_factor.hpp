#pragma once

#include <ceres/sized_cost_function.h>

#include "shared/factors/parameters.hpp"

namespace fleetloc {

/// Roll and pitch measured against gravity, whitened: difference of the map's z axis, in body, from
/// the measured direction upwards, along two axes normal to that direction. Yaw and position are
/// not constrained. Parameters: T_map_body (7).
class TiltFactor final : public ceres::SizedCostFunction<2, 7> {
 public:
  /// @param up_body  unit vector against gravity, in body
  /// @param sigma_rad  of the measurement and of the map's own tilt together
  TiltFactor(const Eigen::Vector3d& up_body, double sigma_rad);
  bool Evaluate(const double* const* parameters,
                double* residuals,
                double** jacobians) const override;

 private:
  Eigen::Matrix<double, 2, 3> whitened_axes_;
};

}  // namespace fleetloc
