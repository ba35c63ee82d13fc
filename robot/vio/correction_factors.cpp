#include "robot/vio/correction_factors.hpp"

#include <array>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

// S with S^T S = information; what the map has not seen may have no information at all.
Eigen::Matrix3d square_root_of(const Eigen::Matrix3d& information) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(information);
  const Eigen::Vector3d roots = eigen.eigenvalues().unaryExpr(
      [](double value) { return value > 0.0 ? std::sqrt(value) : 0.0; });
  return roots.asDiagonal() * eigen.eigenvectors().transpose();
}

const double* chosen(const double* current, const PoseParameters* first_estimate) {
  return first_estimate != nullptr ? first_estimate->data() : current;
}

}  // namespace

LandmarkCorrectionFactor::LandmarkCorrectionFactor(const Correction::Landmark& correction,
                                                   const PoseParameters* first_estimate)
    : p_anchor_(correction.p_anchor),
      sqrt_information_(square_root_of(correction.information)),
      first_estimate_(first_estimate) {}

bool LandmarkCorrectionFactor::Evaluate(const double* const* parameters,
                                        double* residuals,
                                        double** jacobians) const {
  const Eigen::Map<const Eigen::Vector3d> p_odom(parameters[1]);
  const Eigen::Vector3d seen = inverse(pose_from(parameters[0])) * Eigen::Vector3d(p_odom);
  Eigen::Map<Eigen::Vector3d>{residuals}.noalias() = sqrt_information_ * (seen - p_anchor_);
  if (jacobians == nullptr) {
    return true;
  }
  const Pose T_anchor_odom = inverse(pose_from(chosen(parameters[0], first_estimate_)));
  if (jacobians[0] != nullptr) {
    RowMajorMap<3, 7> J(jacobians[0]);
    J.leftCols<3>().noalias() = sqrt_information_ * hat(T_anchor_odom * Eigen::Vector3d(p_odom));
    J.middleCols<3>(3) = -sqrt_information_;
    J.col(6).setZero();
  }
  if (jacobians[1] != nullptr) {
    RowMajorMap<3, 3>(jacobians[1]).noalias() =
        sqrt_information_ * T_anchor_odom.R.toRotationMatrix();
  }
  return true;
}

PoseCorrectionFactor::PoseCorrectionFactor(const Correction::RelativePose& correction,
                                           const PoseParameters* first_from,
                                           const PoseParameters* first_to)
    : factor_(correction.T_from_to, correction.information),
      first_from_(first_from),
      first_to_(first_to) {}

bool PoseCorrectionFactor::Evaluate(const double* const* parameters,
                                    double* residuals,
                                    double** jacobians) const {
  factor_.Evaluate(parameters, residuals, nullptr);
  if (jacobians == nullptr) {
    return true;
  }
  const std::array linearized_at{chosen(parameters[0], first_from_),
                                 chosen(parameters[1], first_to_)};
  Vector6d there;
  return factor_.Evaluate(linearized_at.data(), there.data(), jacobians);
}

}  // namespace fleetloc
