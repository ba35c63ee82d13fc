#include "cloud/localizer/window_system.hpp"

namespace fleetloc {

Eigen::MatrixXd last_of_inverse(const Eigen::LLT<Eigen::MatrixXd>& cholesky, Eigen::Index size) {
  const auto& factor = cholesky.matrixLLT();
  const Eigen::MatrixXd L = factor.bottomRightCorner(size, size);
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Identity(size, size);
  L.triangularView<Eigen::Lower>().solveInPlace(inverse);
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(size, size);
  result.selfadjointView<Eigen::Lower>().rankUpdate(inverse.transpose());
  return result.selfadjointView<Eigen::Lower>();
}

std::optional<Matrix6d> WindowSystem::covariance_of_newest() const {
  if (cholesky.info() != Eigen::Success) return std::nullopt;
  const Matrix6d covariance = last_of_inverse(cholesky, 6);
  if (!covariance.allFinite()) return std::nullopt;
  return covariance;
}

std::size_t WindowSystem::memory_bytes() const {
  const auto elements = static_cast<std::size_t>(cholesky.matrixLLT().size() + H_robot.size());
  std::size_t couplings = 0;
  for (const Landmark& landmark : landmarks) couplings += landmark.equations.couplings.capacity();
  return elements * sizeof(double) + T_map_body.capacity() * sizeof(Pose) +
         landmarks.capacity() * sizeof(Landmark) + couplings * sizeof(PointEquations::Coupling);
}

}  // namespace fleetloc
