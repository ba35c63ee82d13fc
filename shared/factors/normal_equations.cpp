#include "shared/factors/normal_equations.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numeric>

#include <Eigen/Eigenvalues>

namespace fleetloc {
namespace {

constexpr int kPoseSize = 7;
constexpr std::size_t kUsualCouplings = 8;
constexpr double kSingular = 1e-12;  // ratio of eigenvalues of a point's own block
constexpr double kRegular = 1e-6;    // not to be looked at more closely

using Columns = PointEquations::Columns;

Columns& coupling(PointEquations& point, int kept) {
  for (PointEquations::Coupling& known : point.couplings) {
    if (known.kept == kept) return known.H;
  }
  if (point.couplings.empty()) point.couplings.reserve(kUsualCouplings);
  point.couplings.push_back({kept, Columns::Zero()});
  return point.couplings.back().H;
}

// Moore-Penrose inverse, of what counts as regular.
Eigen::Matrix3d pseudo_inverse(const Eigen::Matrix3d& H) {
  // The least eigenvalue by the greatest is at least this.
  if (H.determinant() > kRegular * std::pow(H.trace(), 3)) return H.inverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(H);
  const double min_eigenvalue = kSingular * eigen.eigenvalues()(2);
  const Eigen::Vector3d inverse = eigen.eigenvalues().unaryExpr(
      [min_eigenvalue](double value) { return value > min_eigenvalue ? 1.0 / value : 0.0; });
  return eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
}

// sum += weight * a^T b, row by row: reprojection errors have few of them.
template <typename A, typename B, typename Sum>
void add_products(const A& a, const B& b, double weight, Sum&& sum) {
  for (Eigen::Index row = 0; row < a.rows(); ++row) {
    sum.noalias() += (weight * a.row(row)).transpose() * b.row(row);
  }
}

}  // namespace

NormalEquationsBuilder::NormalEquationsBuilder(const std::vector<ParameterBlock>& kept,
                                               const std::vector<const double*>& eliminated_points)
    : kept_(kept), points_(eliminated_points.size()) {
  int size = 0;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    place_[kept[i].values] = static_cast<int>(i);
    offsets_.push_back(size);
    size += kept[i].tangent_size;
  }
  for (std::size_t i = 0; i < eliminated_points.size(); ++i) {
    place_[eliminated_points[i]] = -1 - static_cast<int>(i);
  }
  sums_.H = Eigen::MatrixXd::Zero(size, size);
  sums_.g = Eigen::VectorXd::Zero(size);
}

void NormalEquationsBuilder::add(const ResidualBlock& block) {
  evaluate(block);
  const int rows = block.cost->num_residuals();
  const Eigen::Map<const Eigen::VectorXd> r(residuals_.data(), rows);
  const double weight = weighted_cost(block.loss, r.squaredNorm());
  slots_.clear();
  for (std::size_t i = 0; i < block.parameters.size(); ++i) {
    const auto found = place_.find(block.parameters[i]);
    if (found != place_.end()) {
      const int ambient = block.cost->parameter_block_sizes()[i];
      const int tangent = ambient == kPoseSize ? kPoseSize - 1 : ambient;
      assert(found->second < 0 ? tangent == 3 : tangent == kept_size(found->second));
      slots_.push_back(
          {found->second,
           {jacobians_[i].data(), jacobians_[i].rows(), tangent, Eigen::OuterStride<>(ambient)}});
    }
  }
  accumulate(r, weight);
}

NormalEquations NormalEquationsBuilder::reduced() const {
  NormalEquations result = sums_;
  for (const PointEquations& point : points_) {
    const Eigen::Matrix3d inverse = pseudo_inverse(point.H);
    for (const PointEquations::Coupling& a : point.couplings) {
      const Columns K = a.H * inverse;
      const int begin = offset(a.kept);
      result.g.segment<6>(begin).noalias() -= K * point.g;
      for (const PointEquations::Coupling& b : point.couplings) {
        if (b.kept >= a.kept) {
          result.H.block<6, 6>(begin, offset(b.kept)).noalias() -= K.lazyProduct(b.H.transpose());
        }
      }
    }
  }
  result.H.triangularView<Eigen::StrictlyLower>() = result.H.transpose();
  return result;
}

void NormalEquationsBuilder::evaluate(const ResidualBlock& block) {
  const auto& sizes = block.cost->parameter_block_sizes();
  const int rows = block.cost->num_residuals();
  assert(sizes.size() == block.parameters.size());
  residuals_.resize(static_cast<std::size_t>(rows));
  jacobians_.resize(sizes.size());
  pointers_.resize(sizes.size());
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    jacobians_[i].resize(rows, sizes[i]);
    pointers_[i] = jacobians_[i].data();
  }
  [[maybe_unused]] const bool valid =
      block.cost->Evaluate(block.parameters.data(), residuals_.data(), pointers_.data());
  assert(valid);
}

// Adds to the cost and returns rho', the weight of the block.
double NormalEquationsBuilder::weighted_cost(const ceres::LossFunction* loss, double squared_norm) {
  std::array<double, 3> rho{squared_norm, 1.0, 0.0};
  if (loss != nullptr) {
    loss->Evaluate(squared_norm, rho.data());
  }
  sums_.cost += 0.5 * rho[0];
  return rho[1];
}

void NormalEquationsBuilder::accumulate(const Eigen::Map<const Eigen::VectorXd>& r, double weight) {
  for (const Slot& a : slots_) {
    if (a.place < 0) {
      PointEquations& point = points_[static_cast<std::size_t>(-1 - a.place)];
      const auto J = a.columns<3>();
      add_products(J, J, weight, point.H);
      point.g.noalias() += weight * J.transpose().lazyProduct(r);
      continue;
    }
    const auto size = a.J.cols();
    sums_.g.segment(offset(a.place), size).noalias() += weight * a.J.transpose().lazyProduct(r);
    for (const Slot& b : slots_) {
      if (b.place == a.place && size == 6) {
        const auto J = a.columns<6>();
        add_products(J, J, weight, sums_.H.block<6, 6>(offset(a.place), offset(a.place)));
      } else if (b.place >= a.place) {  // upper triangle only
        sums_.H.block(offset(a.place), offset(b.place), size, b.J.cols()).noalias() +=
            weight * a.J.transpose().lazyProduct(b.J);
      } else if (b.place < 0) {
        assert(size == 6);
        add_products(a.columns<6>(),
                     b.columns<3>(),
                     weight,
                     coupling(points_[static_cast<std::size_t>(-1 - b.place)], a.place));
      }
    }
  }
}

NormalEquations schur_complement(const std::vector<ResidualBlock>& blocks,
                                 const std::vector<ParameterBlock>& kept,
                                 const std::vector<const double*>& eliminated_points) {
  NormalEquationsBuilder builder(kept, eliminated_points);
  for (const ResidualBlock& block : blocks) builder.add(block);
  return builder.reduced();
}

}  // namespace fleetloc
