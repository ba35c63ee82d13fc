#include "robot/fusion/map_tilt.hpp"

#include <Eigen/Cholesky>

#include "shared/geometry/so3.hpp"

namespace fleetloc {

MapTilt tilt_of(const Eigen::Quaterniond& R_map_odom) {
  const Eigen::Vector3d up_odom = R_map_odom.conjugate() * Eigen::Vector3d::UnitZ();
  return {up_odom.head<2>(), hat(up_odom).topRows<2>()};
}

double chi_square(const MapTilt& tilt, const Matrix6d& covariance, double map_tilt) {
  const Eigen::Matrix2d S =
      tilt.J_rotation * covariance.topLeftCorner<3, 3>() * tilt.J_rotation.transpose() +
      map_tilt * map_tilt * Eigen::Matrix2d::Identity();
  return tilt.value.dot(S.llt().solve(tilt.value));
}

}  // namespace fleetloc
