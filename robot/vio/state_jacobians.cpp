#include "robot/vio/state_jacobians.hpp"

#include <Eigen/Geometry>

#include "shared/geometry/so3.hpp"

namespace fleetloc {

Eigen::Matrix<double, 15, 4> jacobian_by_yaw_and_position(const Pose& T_odom_other,
                                                          const NavState& state) {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const Eigen::Matrix3d R_body_odom = state.T_odom_body.R.toRotationMatrix().transpose();
  Eigen::Matrix<double, 15, 4> J = Eigen::Matrix<double, 15, 4>::Zero();
  J.block<3, 1>(0, 0) = R_body_odom * up;
  J.block<3, 1>(3, 0) = R_body_odom * up.cross(state.T_odom_body.p - T_odom_other.p);
  J.block<3, 3>(3, 1) = R_body_odom;
  J.block<3, 1>(6, 0) = up.cross(state.v_odom);
  return J;
}

Eigen::Matrix<double, 15, 6> jacobian_by_pose(const Pose& T_odom_other, const NavState& state) {
  Eigen::Matrix<double, 15, 6> J = Eigen::Matrix<double, 15, 6>::Zero();
  J.topRows<6>() = adjoint(inverse(state.T_odom_body) * T_odom_other);
  J.block<3, 3>(6, 0) = -hat(state.v_odom) * T_odom_other.R.toRotationMatrix();
  return J;
}

}  // namespace fleetloc
