#include "shared/geometry/covariance.hpp"

#include <cmath>

#include <Eigen/Eigenvalues>

namespace fleetloc {

double max_sigma(const Eigen::Matrix3d& covariance) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
  eigen.computeDirect(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(eigen.eigenvalues()(2));
}

Matrix6d diagonal_covariance(double sigma_rad, double sigma_m) {
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(sigma_rad * sigma_rad),
      Eigen::Vector3d::Constant(sigma_m * sigma_m);
  return variances.asDiagonal();
}

}  // namespace fleetloc
