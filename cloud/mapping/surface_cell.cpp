#include "cloud/mapping/surface_cell.hpp"

#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace fleetloc {
namespace {

constexpr int kEnoughPoints = 8;             // for a direction from the cell alone
constexpr int kFewestPoints = 3;             // for any direction
constexpr float kPointSigma = 0.02F;         // of a single point [m]
constexpr float kMaxPlanarFlatness = 0.35F;  // greatest sigma_0 / sigma_1
constexpr float kLineWidth = 0.3F;           // greatest sigma_1 / sigma_2
constexpr float kUprightCosine = 0.8F;

}  // namespace

void PointMoments::add(const Eigen::Vector3f& offset) {
  ++count_;
  sum_ += offset;
  squares_ += offset * offset.transpose();
}

void PointMoments::add(const PointMoments& other, const Eigen::Vector3f& shift) {
  const auto count = static_cast<float>(other.count_);
  const Eigen::Matrix3f mixed = other.sum_ * shift.transpose();
  count_ += other.count_;
  sum_ += other.sum_ + count * shift;
  squares_ += other.squares_ + mixed + mixed.transpose() + count * shift * shift.transpose();
}

Eigen::Matrix3f PointMoments::covariance() const {
  const auto count = static_cast<float>(count_);
  return (squares_ - sum_ * sum_.transpose() / count) / count;
}

SurfaceCell surface_of(const PointMoments& own,
                       const PointMoments& around,
                       const Eigen::Vector3f& origin_map) {
  using Solver = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f>;
  SurfaceCell cell;
  cell.p_map = origin_map + own.mean();
  cell.kind = SurfaceCell::Kind::kNonPlanar;
  const Eigen::Matrix3f covariance = own.covariance();
  const Eigen::Matrix3f ball = kPointSigma * kPointSigma * Eigen::Matrix3f::Identity();
  cell.information = (covariance + ball).inverse();
  Solver solver;
  solver.computeDirect(covariance);
  if (own.count() < kEnoughPoints) {
    if (around.count() < kFewestPoints) return cell;
    solver.computeDirect(around.covariance());
  }
  const Eigen::Vector3f sigmas = solver.eigenvalues().cwiseMax(0.0F).cwiseSqrt();
  if (sigmas(1) < kLineWidth * sigmas(2)) {
    const bool upright = std::abs(solver.eigenvectors().col(2).z()) > kUprightCosine;
    if (!upright) cell.kind = SurfaceCell::Kind::kUnknown;
  } else if (sigmas(0) < kMaxPlanarFlatness * sigmas(1)) {
    cell.kind = SurfaceCell::Kind::kPlanar;
    cell.normal = solver.eigenvectors().col(0);
  }
  return cell;
}

}  // namespace fleetloc
