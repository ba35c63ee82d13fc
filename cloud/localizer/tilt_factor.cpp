#include "cloud/localizer/tilt_factor.hpp"

#include <cassert>

#include "shared/geometry/so3.hpp"

namespace fleetloc {

TiltFactor::TiltFactor(const Eigen::Vector3d& up_body, double sigma_rad) {
  assert(sigma_rad > 0.0);
  const Eigen::Vector3d a = up_body.unitOrthogonal();
  whitened_axes_.row(0) = a.transpose() / sigma_rad;
  whitened_axes_.row(1) = up_body.cross(a).transpose() / sigma_rad;
}

bool TiltFactor::Evaluate(const double* const* parameters,
                          double* residuals,
                          double** jacobians) const {
  const Eigen::Vector3d z_body = pose_from(parameters[0]).R.conjugate() * Eigen::Vector3d::UnitZ();
  Eigen::Map<Eigen::Vector2d>{residuals}.noalias() = whitened_axes_ * z_body;
  if (jacobians != nullptr && jacobians[0] != nullptr) {
    RowMajorMap<2, 7> J_pose(jacobians[0]);
    J_pose.setZero();
    J_pose.leftCols<3>().noalias() = whitened_axes_ * hat(z_body);  // Exp(-phi) z = z + z x phi
  }
  return true;
}

}  // namespace fleetloc
