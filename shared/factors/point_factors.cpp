#include "shared/factors/point_factors.hpp"

#include <cassert>
#include <utility>

namespace fleetloc {

PointToPlaneFactor::PointToPlaneFactor(Eigen::Vector3d q_map,
                                       const Eigen::Vector3d& normal,
                                       double sigma_m)
    : q_map_(std::move(q_map)), whitened_normal_(normal / sigma_m) {
  assert(sigma_m > 0.0);
}

bool PointToPlaneFactor::Evaluate(const double* const* parameters,
                                  double* residuals,
                                  double** jacobians) const {
  const Eigen::Map<const Eigen::Vector3d> p_map(parameters[0]);
  residuals[0] = whitened_normal_.dot(p_map - q_map_);
  if (jacobians != nullptr && jacobians[0] != nullptr) {
    Eigen::Map<Eigen::RowVector3d>(jacobians[0]).noalias() = whitened_normal_.transpose();
  }
  return true;
}

PointToPointFactor::PointToPointFactor(Eigen::Vector3d q_map, double sigma_m)
    : q_map_(std::move(q_map)), inverse_sigma_(1.0 / sigma_m) {
  assert(sigma_m > 0.0);
}

bool PointToPointFactor::Evaluate(const double* const* parameters,
                                  double* residuals,
                                  double** jacobians) const {
  const Eigen::Map<const Eigen::Vector3d> p_map(parameters[0]);
  Eigen::Map<Eigen::Vector3d>{residuals}.noalias() = inverse_sigma_ * (p_map - q_map_);
  if (jacobians != nullptr && jacobians[0] != nullptr) {
    RowMajorMap<3, 3>(jacobians[0]).noalias() = inverse_sigma_ * Eigen::Matrix3d::Identity();
  }
  return true;
}

}  // namespace fleetloc
