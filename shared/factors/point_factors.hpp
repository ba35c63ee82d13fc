#pragma once

#include <ceres/sized_cost_function.h>

#include "shared/factors/parameters.hpp"

namespace fleetloc {

/// Point to plane (paper, eq. 14), whitened: n . (p - q) / sigma. Parameters: p_map (3).
class PointToPlaneFactor final : public ceres::SizedCostFunction<1, 3> {
 public:
  PointToPlaneFactor(Eigen::Vector3d q_map, const Eigen::Vector3d& normal, double sigma_m);
  bool Evaluate(const double* const* parameters,
                double* residuals,
                double** jacobians) const override;

 private:
  Eigen::Vector3d q_map_;
  Eigen::Vector3d whitened_normal_;
};

/// Point to point (paper, eq. 13), whitened: (p - q) / sigma. Parameters: p_map (3).
class PointToPointFactor final : public ceres::SizedCostFunction<3, 3> {
 public:
  PointToPointFactor(Eigen::Vector3d q_map, double sigma_m);
  bool Evaluate(const double* const* parameters,
                double* residuals,
                double** jacobians) const override;

 private:
  Eigen::Vector3d q_map_;
  double inverse_sigma_;
};

}  // namespace fleetloc
