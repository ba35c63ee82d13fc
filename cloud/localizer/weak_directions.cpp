#include "cloud/localizer/weak_directions.hpp"

#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace fleetloc {
namespace {

// Coordinates along the weak directions, by the right perturbation of T_map_body.
Eigen::MatrixXd weak_by_body(const WeakDirections& weak,
                             const WindowMotion& motion,
                             const Pose& T_map_body) {
  return weak.transpose() * motion.J_body_motion(T_map_body).inverse();
}

}  // namespace

Matrix6d widened_along(const WeakDirections& weak,
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

double weak_sigma(const WeakDirections& weak,
                  const WindowMotion& motion,
                  const PoseWithCovariance& result) {
  if (weak.cols() == 0) return 0.0;
  const Eigen::MatrixXd W = weak_by_body(weak, motion, result.T_map_body);
  const Eigen::MatrixXd covariance = W * result.covariance * W.transpose();
  return std::sqrt(covariance.diagonal().maxCoeff());
}

}  // namespace fleetloc
