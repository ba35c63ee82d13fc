#pragma once

#include <map>
#include <vector>

#include <Eigen/Core>
#include <ceres/cost_function.h>
#include <ceres/loss_function.h>

namespace fleetloc {

/// One residual block and where its parameters stand. Nothing is owned.
struct ResidualBlock {
  const ceres::CostFunction* cost = nullptr;
  const ceres::LossFunction* loss = nullptr;  ///< null: quadratic
  std::vector<const double*> parameters;
};

/// The Gauss-Newton system H dx = -g of some residual blocks at their parameters' current values,
/// in tangent coordinates: H = sum J^T J, g = sum J^T r, both weighted by the robust kernels.
/// Dense over `kept` blocks; `eliminated` 3-vectors (landmarks) are removed by Schur complement.
///
/// Poses (7 ambient, 6 tangent, see PoseManifold) and vectors are told apart by their size.
/// Parameters that are in neither list are constant.
struct NormalEquations {
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
  double cost = 0.0;  ///< 0.5 * sum of robust squared residuals
};

struct ParameterBlock {
  const double* values = nullptr;
  int tangent_size = 0;  ///< 6 for a pose
};

/// Order and offsets of the result follow `kept`. An eliminated point whose own block of H is
/// singular (eigenvalue ratio below 1e-12) contributes only what its regular directions say.
NormalEquations schur_complement(const std::vector<ResidualBlock>& blocks,
                                 const std::vector<ParameterBlock>& kept,
                                 const std::vector<const double*>& eliminated_points);

}  // namespace fleetloc
