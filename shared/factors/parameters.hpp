#pragma once

#include <array>

#include <ceres/manifold.h>

#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// A pose as a Ceres parameter block: [qx qy qz qw px py pz].
using PoseParameters = std::array<double, 7>;
/// A landmark or another point as a Ceres parameter block: [x y z].
using PointParameters = std::array<double, 3>;

PoseParameters to_parameters(const Pose& T);
Pose pose_from(const double* parameters);

/// T * Exp(xi) on PoseParameters. Factors state their Jacobians in the six tangent coordinates:
/// the first six columns of what Ceres calls the ambient Jacobian, its last column is zero.
/// PlusJacobian is [I6; 0] to match, which is exact for every factor of this project.
class PoseManifold final : public ceres::Manifold {
 public:
  [[nodiscard]] int AmbientSize() const override { return 7; }
  [[nodiscard]] int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;
};

/// Views for writing Jacobians: row major as Ceres wants them.
template <int Rows, int Columns>
using RowMajorMap = Eigen::Map<
    Eigen::Matrix<double, Rows, Columns, (Columns == 1 ? Eigen::ColMajor : Eigen::RowMajor)>>;

}  // namespace fleetloc
