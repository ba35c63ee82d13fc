#include "shared/factors/parameters.hpp"

namespace fleetloc {

PoseParameters to_parameters(const Pose& T) {
  return {T.R.x(), T.R.y(), T.R.z(), T.R.w(), T.p.x(), T.p.y(), T.p.z()};
}

Pose pose_from(const double* parameters) {
  return {Eigen::Quaterniond(Eigen::Map<const Eigen::Vector4d>(parameters)),
          Eigen::Map<const Eigen::Vector3d>(parameters + 4)};
}

bool PoseManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  const Pose T = retract(pose_from(x), Eigen::Map<const Vector6d>(delta));
  Eigen::Map<Eigen::Vector4d>(x_plus_delta).noalias() = T.R.coeffs();
  Eigen::Map<Eigen::Vector3d>(x_plus_delta + 4) = T.p;
  return true;
}

bool PoseManifold::PlusJacobian(const double* /*x*/, double* jacobian) const {
  RowMajorMap<7, 6>(jacobian).setIdentity();
  return true;
}

bool PoseManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  Eigen::Map<Vector6d>(y_minus_x).noalias() = local_coordinates(pose_from(x), pose_from(y));
  return true;
}

bool PoseManifold::MinusJacobian(const double* /*x*/, double* jacobian) const {
  RowMajorMap<6, 7>(jacobian).setIdentity();
  return true;
}

}  // namespace fleetloc
