#include "cloud/localizer/pose_anchor.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace fleetloc {
namespace {

using Directions = Eigen::Matrix<double, 6, Eigen::Dynamic>;

// Coordinates along the weak directions, by the right perturbation of T_map_body.
Eigen::MatrixXd weak_by_body(const Directions& weak,
                             const WindowMotion& motion,
                             const Pose& T_map_body) {
  return weak.transpose() * motion.J_body_motion(T_map_body).inverse();
}

}  // namespace

PoseWithCovariance PoseAnchor::at(const Pose& T_odom_later,
                                  double travelled_m_later,
                                  const DriftConfig& drift) const {
  const Pose step = inverse(T_odom_body) * T_odom_later;
  const Matrix6d A = adjoint(inverse(step));
  const double distance = std::max(step.p.norm(), std::abs(travelled_m_later - travelled_m));
  const double rotation = drift.rotation_rad_per_m * distance;
  const double translation = drift.translation_m_per_m * distance;
  PoseWithCovariance result{estimate.T_map_body * step, A * estimate.covariance * A.transpose()};
  result.covariance.diagonal().head<3>().array() += rotation * rotation;
  result.covariance.diagonal().tail<3>().array() += translation * translation;
  return result;
}

Matrix6d information_along(const Directions& weak,
                           const WindowMotion& motion,
                           const PoseWithCovariance& estimate,
                           double min_sigma_m) {
  const Eigen::MatrixXd W = weak_by_body(weak, motion, estimate.T_map_body);
  Eigen::MatrixXd covariance = W * estimate.covariance * W.transpose();
  covariance.diagonal().array() += min_sigma_m * min_sigma_m;
  const Matrix6d information = W.transpose() * covariance.inverse() * W;
  return 0.5 * (information + information.transpose());
}

Matrix6d widened_along(const Directions& weak,
                       const WindowMotion& motion,
                       const PoseWithCovariance& result,
                       const Matrix6d& min_covariance) {
  const Eigen::MatrixXd W = weak_by_body(weak, motion, result.T_map_body);
  const Eigen::MatrixXd missing = W * (min_covariance - result.covariance) * W.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(missing);
  const Eigen::MatrixXd U =
      motion.J_body_motion(result.T_map_body) * weak * eigen.eigenvectors();  // W U = eigenvectors
  return result.covariance + U * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() * U.transpose();
}

DriftConfig read_drift_config(ConfigReader section) {
  return {.translation_m_per_m = section.positive("translation_m_per_m"),
          .rotation_rad_per_m = section.positive("rotation_rad_per_m")};
}

}  // namespace fleetloc
