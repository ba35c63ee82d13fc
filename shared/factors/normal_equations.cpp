#include "shared/factors/normal_equations.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include <Eigen/Eigenvalues>

namespace fleetloc {
namespace {

constexpr int kPoseSize = 7;
constexpr int kMaxTangent = 9;
constexpr double kSingular = 1e-12;  // ratio of eigenvalues of a point's own block

using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using ColumnsByPoint = Eigen::Matrix<double, Eigen::Dynamic, 3, 0, kMaxTangent, 3>;

// Coupling of one point to one kept block.
struct Coupling {
  int kept = 0;
  ColumnsByPoint H;
};

struct Point {
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  std::vector<Coupling> couplings;

  ColumnsByPoint& coupling(int kept, int size) {
    for (Coupling& known : couplings) {
      if (known.kept == kept) {
        return known.H;
      }
    }
    couplings.push_back({kept, ColumnsByPoint::Zero(size, 3)});
    return couplings.back().H;
  }
};

// Moore-Penrose inverse, of what counts as regular.
Eigen::Matrix3d pseudo_inverse(const Eigen::Matrix3d& H) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(H);
  const double least = kSingular * eigen.eigenvalues()(2);
  const Eigen::Vector3d inverse = eigen.eigenvalues().unaryExpr(
      [least](double value) { return value > least ? 1.0 / value : 0.0; });
  return eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
}

class Assembler {
 public:
  Assembler(const std::vector<ParameterBlock>& kept, const std::vector<const double*>& eliminated)
      : kept_(kept), points_(eliminated.size()) {
    int size = 0;
    for (std::size_t i = 0; i < kept.size(); ++i) {
      place_[kept[i].values] = static_cast<int>(i);
      offsets_.push_back(size);
      size += kept[i].tangent_size;
    }
    for (std::size_t i = 0; i < eliminated.size(); ++i) {
      place_[eliminated[i]] = -1 - static_cast<int>(i);
    }
    result_.H = Eigen::MatrixXd::Zero(size, size);
    result_.g = Eigen::VectorXd::Zero(size);
  }

  void add(const ResidualBlock& block) {
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

  // Removes the points.
  NormalEquations finish() {
    for (const Point& point : points_) {
      const Eigen::Matrix3d inverse = pseudo_inverse(point.H);
      for (const Coupling& a : point.couplings) {
        const ColumnsByPoint K = a.H * inverse;
        const int begin = offset(a.kept);
        result_.g.segment(begin, K.rows()).noalias() -= K * point.g;
        for (const Coupling& b : point.couplings) {
          if (b.kept >= a.kept) {
            result_.H.block(begin, offset(b.kept), K.rows(), b.H.rows()).noalias() -=
                K.lazyProduct(b.H.transpose());
          }
        }
      }
    }
    result_.H.triangularView<Eigen::StrictlyLower>() = result_.H.transpose();
    return std::move(result_);
  }

 private:
  struct Slot {
    int place = 0;  // of a kept block; -1 - i: the i-th point
    Eigen::Map<const Jacobian, 0, Eigen::OuterStride<>> J;
  };

  int kept_size(int place) const { return kept_[static_cast<std::size_t>(place)].tangent_size; }
  int offset(int place) const { return offsets_[static_cast<std::size_t>(place)]; }

  void evaluate(const ResidualBlock& block) {
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
  double weighted_cost(const ceres::LossFunction* loss, double squared_norm) {
    std::array<double, 3> rho{squared_norm, 1.0, 0.0};
    if (loss != nullptr) {
      loss->Evaluate(squared_norm, rho.data());
    }
    result_.cost += 0.5 * rho[0];
    return rho[1];
  }

  void accumulate(const Eigen::Map<const Eigen::VectorXd>& r, double weight) {
    for (const Slot& a : slots_) {
      if (a.place < 0) {
        Point& point = points_[static_cast<std::size_t>(-1 - a.place)];
        point.H.noalias() += weight * a.J.transpose().lazyProduct(a.J);
        point.g.noalias() += weight * a.J.transpose().lazyProduct(r);
        continue;
      }
      const auto size = a.J.cols();
      result_.g.segment(offset(a.place), size).noalias() += weight * a.J.transpose().lazyProduct(r);
      for (const Slot& b : slots_) {
        if (b.place >= a.place) {  // upper triangle only
          result_.H.block(offset(a.place), offset(b.place), size, b.J.cols()).noalias() +=
              weight * a.J.transpose().lazyProduct(b.J);
        } else if (b.place < 0) {
          points_[static_cast<std::size_t>(-1 - b.place)]
              .coupling(a.place, static_cast<int>(size))
              .noalias() += weight * a.J.transpose().lazyProduct(b.J);
        }
      }
    }
  }

  const std::vector<ParameterBlock>& kept_;
  std::vector<int> offsets_;
  std::unordered_map<const double*, int> place_;  // looked up only
  std::vector<Point> points_;
  NormalEquations result_;
  // Scratch of add().
  std::vector<double> residuals_;
  std::vector<Jacobian> jacobians_;
  std::vector<double*> pointers_;
  std::vector<Slot> slots_;
};

}  // namespace

NormalEquations schur_complement(const std::vector<ResidualBlock>& blocks,
                                 const std::vector<ParameterBlock>& kept,
                                 const std::vector<const double*>& eliminated_points) {
  Assembler assembler(kept, eliminated_points);
  for (const ResidualBlock& block : blocks) {
    assembler.add(block);
  }
  return assembler.finish();
}

}  // namespace fleetloc
