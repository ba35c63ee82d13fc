#include "cloud/localizer/weak_directions.hpp"

#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace fleetloc {
namespace {

// Coordinates along the weak directions, by the right perturbation of T_map_body.
Eigen::MatrixXd weak_by_body(const MapConstraint& constraint, const Pose& T_map_body) {
  return constraint.weak.transpose() * constraint.motion.J_body_motion(T_map_body).inverse();
}

}  // namespace

Matrix6d widened_along(const MapConstraint& constraint,
                       const PoseWithCovariance& result,
                       const Matrix6d& min_covariance) {
  const Eigen::MatrixXd W = weak_by_body(constraint, result.T_map_body);
  const Eigen::MatrixXd missing = W * (min_covariance - result.covariance) * W.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(missing);
  const Eigen::MatrixXd U = constraint.motion.J_body_motion(result.T_map_body) * constraint.weak *
                            eigen.eigenvectors();  // W U = eigenvectors
  return result.covariance + U * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() * U.transpose();
}

double weak_sigma(const MapConstraint& constraint, const PoseWithCovariance& result) {
  if (constraint.weak.cols() == 0) return 0.0;
  const Eigen::MatrixXd W = weak_by_body(constraint, result.T_map_body);
  const Eigen::MatrixXd covariance = W * result.covariance * W.transpose();
  return std::sqrt(covariance.diagonal().maxCoeff());
}

}  // namespace fleetloc
