#include "shared/geometry/covariance.hpp"

#include <cmath>

#include <Eigen/Eigenvalues>

namespace fleetloc {

double max_sigma(const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(eigen.eigenvalues()(2));
}

}  // namespace fleetloc
