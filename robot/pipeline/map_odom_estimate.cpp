#include "robot/pipeline/map_odom_estimate.hpp"

namespace fleetloc {

MapOdomEstimate map_odom_estimate_at(const Pose& T_map_body,
                                     const Pose& T_odom_body,
                                     const StartUncertainty& sigma) {
  const Eigen::Matrix3d R_body_map = T_map_body.R.toRotationMatrix().transpose();
  const Eigen::Vector3d rotation_sigma(
      sigma.tilt_sigma_rad, sigma.tilt_sigma_rad, sigma.yaw_sigma_rad);
  Matrix6d covariance_body = Matrix6d::Zero();
  covariance_body.topLeftCorner<3, 3>() =
      R_body_map * rotation_sigma.cwiseAbs2().asDiagonal() * R_body_map.transpose();
  covariance_body.bottomRightCorner<3, 3>() =
      Eigen::Matrix3d::Identity() * sigma.position_sigma_m * sigma.position_sigma_m;
  const Matrix6d A = adjoint(T_odom_body);
  return {.T_map_odom = T_map_body * inverse(T_odom_body),
          .covariance = A * covariance_body * A.transpose(),
          .p_odom = T_odom_body.p};
}

}  // namespace fleetloc
