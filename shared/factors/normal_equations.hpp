#pragma once

#include <unordered_map>
#include <vector>

#include <Eigen/Core>
#include <ceres/cost_function.h>
#include <ceres/loss_function.h>

namespace fleetloc {

/// One residual block and pointers to its parameters. Owns nothing.
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

/// The terms of a point that is to be eliminated: its own block of H, its gradient, and its
/// coupling to kept poses. Its factors may have no other parameters.
struct PointEquations {
  using Columns = Eigen::Matrix<double, 6, 3>;
  struct Coupling {
    int kept = 0;  ///< index of the kept block
    Columns H;
  };
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  std::vector<Coupling> couplings;
};

/// Accumulates NormalEquations residual block by residual block. The sum so far can be reduced to
/// the kept parameters at any time.
class NormalEquationsBuilder {
 public:
  NormalEquationsBuilder(const std::vector<ParameterBlock>& kept,
                         const std::vector<const double*>& eliminated_points);

  void add(const ResidualBlock& block);

  /// See schur_complement().
  [[nodiscard]] NormalEquations reduced() const;

  /// In the order of the eliminated points.
  [[nodiscard]] const std::vector<PointEquations>& points() const { return points_; }

 private:
  using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  struct Slot {
    int place = 0;  // index of a kept block; -1 - i: the i-th point
    Eigen::Map<const Jacobian, 0, Eigen::OuterStride<>> J;

    template <int Size>
    [[nodiscard]] auto columns() const {
      using Columns = Eigen::Matrix<double, Eigen::Dynamic, Size, Eigen::RowMajor>;
      return Eigen::Map<const Columns, 0, Eigen::OuterStride<>>(
          J.data(), J.rows(), Size, Eigen::OuterStride<>(J.outerStride()));
    }
  };

  void evaluate(const ResidualBlock& block);
  double weighted_cost(const ceres::LossFunction* loss, double squared_norm);
  void accumulate(const Eigen::Map<const Eigen::VectorXd>& r, double weight);
  [[nodiscard]] int kept_size(int place) const {
    return kept_[static_cast<std::size_t>(place)].tangent_size;
  }
  [[nodiscard]] int offset(int place) const { return offsets_[static_cast<std::size_t>(place)]; }

  std::vector<ParameterBlock> kept_;
  std::vector<int> offsets_;
  std::unordered_map<const double*, int> place_;  // looked up only
  std::vector<PointEquations> points_;
  NormalEquations sums_;  // upper triangle, points not yet eliminated
  // Scratch of add().
  std::vector<double> residuals_;
  std::vector<Jacobian> jacobians_;
  std::vector<double*> pointers_;
  std::vector<Slot> slots_;
};

/// Order and offsets of the result follow `kept`. An eliminated point whose own block of H is
/// singular (eigenvalue ratio below 1e-12) contributes only in its regular directions.
NormalEquations schur_complement(const std::vector<ResidualBlock>& blocks,
                                 const std::vector<ParameterBlock>& kept,
                                 const std::vector<const double*>& eliminated_points);

}  // namespace fleetloc
