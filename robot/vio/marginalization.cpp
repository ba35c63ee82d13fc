#include "robot/vio/marginalization.hpp"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include "shared/factors/parameters.hpp"

namespace fleetloc {
namespace {

constexpr Eigen::Index kPoseSize = 7;
constexpr double kUnknown = 1e-12;   // ratio of eigenvalues
constexpr double kRoundOff = 1e-14;  // of a diagonal's largest element

// D with ones on the diagonal of D H D, zeros where H has nothing but round-off.
Eigen::VectorXd diagonal_scale(const Eigen::MatrixXd& H) {
  const double min_value = kRoundOff * H.diagonal().maxCoeff();
  return H.diagonal().unaryExpr(
      [min_value](double value) { return value > min_value ? 1.0 / std::sqrt(value) : 0.0; });
}

}  // namespace

int PriorState::tangent_size() const {
  return static_cast<int>(first.size() == kPoseSize ? kPoseSize - 1 : first.size());
}

Eigen::VectorXd difference(const PriorState& first, const double* x) {
  if (first.first.size() == kPoseSize) {
    return local_coordinates(pose_from(first.first.data()), pose_from(x));
  }
  return Eigen::Map<const Eigen::VectorXd>(x, first.first.size()) - first.first;
}

MarginalizationPrior::MarginalizationPrior(std::vector<PriorState> states,
                                           const Eigen::MatrixXd& H,
                                           const Eigen::VectorXd& g)
    : states_(std::move(states)) {
  const Eigen::VectorXd scale = diagonal_scale(H);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scale.asDiagonal() * H *
                                                             scale.asDiagonal());
  const Eigen::VectorXd& values = eigen.eigenvalues();  // increasing
  Eigen::Index unknown = 0;
  while (unknown < values.size() && values(unknown) <= kUnknown * values(values.size() - 1)) {
    ++unknown;
  }
  const Eigen::Index known = values.size() - unknown;
  const Eigen::VectorXd roots = values.tail(known).cwiseSqrt();
  const Eigen::MatrixXd V = eigen.eigenvectors().rightCols(known);
  const Eigen::VectorXd unscale =
      scale.unaryExpr([](double value) { return value > 0.0 ? 1.0 / value : 0.0; });
  J_ = roots.asDiagonal() * V.transpose() * unscale.asDiagonal();
  e0_ = roots.cwiseInverse().asDiagonal() * (V.transpose() * (scale.asDiagonal() * g));
  set_num_residuals(static_cast<int>(known));
  for (const PriorState& state : states_) {
    mutable_parameter_block_sizes()->push_back(static_cast<int>(state.first.size()));
  }
}

bool MarginalizationPrior::Evaluate(const double* const* parameters,
                                    double* residuals,
                                    double** jacobians) const {
  Eigen::Map<Eigen::VectorXd> residual(residuals, J_.rows());
  residual = e0_;
  Eigen::Index column = 0;
  for (std::size_t i = 0; i < states_.size(); ++i) {
    const Eigen::Index size = states_[i].tangent_size();
    residual.noalias() += J_.middleCols(column, size) * difference(states_[i], parameters[i]);
    if (jacobians != nullptr && jacobians[i] != nullptr) {
      using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
      Eigen::Map<RowMajor> target(jacobians[i], J_.rows(), states_[i].first.size());
      target.leftCols(size) = J_.middleCols(column, size);
      target.rightCols(target.cols() - size).setZero();
    }
    column += size;
  }
  return true;
}

NormalEquations marginalize_leading(const NormalEquations& system, Eigen::Index count) {
  const Eigen::Index rest = system.H.rows() - count;
  const Eigen::VectorXd scale = diagonal_scale(system.H.topLeftCorner(count, count));
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
      scale.asDiagonal() * system.H.topLeftCorner(count, count) * scale.asDiagonal());
  const double min_value = kUnknown * eigen.eigenvalues()(count - 1);
  const Eigen::VectorXd inverse_roots = eigen.eigenvalues().unaryExpr(
      [min_value](double value) { return value > min_value ? 1.0 / std::sqrt(value) : 0.0; });
  // H_mm^-1 = W W^T
  const Eigen::MatrixXd W = scale.asDiagonal() * eigen.eigenvectors() * inverse_roots.asDiagonal();
  const Eigen::MatrixXd K = system.H.bottomLeftCorner(rest, count) * W;
  NormalEquations result;
  result.H = system.H.bottomRightCorner(rest, rest);
  result.H.noalias() -= K * K.transpose();
  result.g = system.g.tail(rest) - K * (W.transpose() * system.g.head(count));
  result.cost = system.cost;
  return result;
}

Eigen::MatrixXd gauge_directions(const std::vector<PriorState>& states) {
  Eigen::Index size = 0;
  for (const PriorState& state : states) {
    size += state.tangent_size();
  }
  Eigen::MatrixXd N = Eigen::MatrixXd::Zero(size, 4);
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  Eigen::Index row = 0;
  for (const PriorState& state : states) {
    if (state.first.size() == kPoseSize) {
      const Pose T = pose_from(state.first.data());
      const Eigen::Matrix3d R_body_odom = T.R.toRotationMatrix().transpose();
      N.block<3, 1>(row, 0) = R_body_odom * up;
      N.block<3, 1>(row + 3, 0) = R_body_odom * up.cross(T.p);
      N.block<3, 3>(row + 3, 1) = R_body_odom;
    } else {
      N.block<3, 1>(row, 0) = up.cross(Eigen::Vector3d(state.first.head<3>()));
    }
    row += state.tangent_size();
  }
  return N;
}

void project_out(const Eigen::MatrixXd& gauge, NormalEquations& system) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(gauge);
  const Eigen::MatrixXd Q =
      qr.householderQ() * Eigen::MatrixXd::Identity(gauge.rows(), gauge.cols());
  system.g -= Q * (Q.transpose() * system.g);
  const Eigen::MatrixXd columns = system.H * Q;
  system.H -= columns * Q.transpose();
  const Eigen::MatrixXd rows = Q.transpose() * system.H;
  system.H -= Q * rows;
  system.H = 0.5 * (system.H + system.H.transpose()).eval();
}

}  // namespace fleetloc
