#include "robot/vio/gauge_factor.hpp"

#include <utility>

#include "shared/geometry/so3.hpp"

namespace fleetloc {

Eigen::Matrix<double, 4, 6> yaw_and_position_jacobian(const Pose& T_odom_body) {
  const Eigen::Matrix3d R = T_odom_body.R.toRotationMatrix();
  Eigen::Matrix<double, 4, 6> J = Eigen::Matrix<double, 4, 6>::Zero();
  J.topLeftCorner<1, 3>() = R.row(2);
  J.bottomRightCorner<3, 3>() = R;
  return J;
}

GaugeFactor::GaugeFactor(Pose T_fixed, const PoseParameters* first_estimate)
    : T_fixed_(std::move(T_fixed)), first_estimate_(first_estimate) {}

bool GaugeFactor::Evaluate(const double* const* parameters,
                           double* residuals,
                           double** jacobians) const {
  const Pose T = pose_from(parameters[0]);
  residuals[0] = log_so3(T.R * T_fixed_.R.conjugate()).z() / kSigma;
  Eigen::Map<Eigen::Vector3d>{residuals + 1}.noalias() = (T.p - T_fixed_.p) / kSigma;
  if (jacobians != nullptr && jacobians[0] != nullptr) {
    const Pose at = first_estimate_ != nullptr ? pose_from(first_estimate_->data()) : T;
    RowMajorMap<4, 7> J(jacobians[0]);
    J.leftCols<6>() = yaw_and_position_jacobian(at) / kSigma;
    J.col(6).setZero();
  }
  return true;
}

}  // namespace fleetloc
