#pragma once

#include <ceres/sized_cost_function.h>

#include "shared/factors/parameters.hpp"
#include "shared/factors/relative_pose_factor.hpp"
#include "shared/model/correction.hpp"

/// The cloud's constraints on a window (paper, eq. 9 and 10), whitened. They are relative: yaw and
/// position in odom stay unobservable, as long as every Jacobian is taken where the prior was
/// linearized. A first estimate, if given, is the pose at which all Jacobians are taken instead of
/// its current value; it must outlive the factor.
namespace fleetloc {

/// e_pp (paper, eq. 9): S * (T_odom_anchor^-1 * p_odom - p_anchor), S^T S the information.
/// Parameters: T_odom_anchor (7), p_odom (3).
class LandmarkCorrectionFactor final : public ceres::SizedCostFunction<3, 7, 3> {
 public:
  explicit LandmarkCorrectionFactor(const Correction::Landmark& correction,
                                    const PoseParameters* first_estimate = nullptr);
  bool Evaluate(const double* const* parameters,
                double* residuals,
                double** jacobians) const override;

 private:
  Eigen::Vector3d p_anchor_;
  Eigen::Matrix3d sqrt_information_;
  const PoseParameters* first_estimate_;
};

/// e_rt (paper, eq. 10): RelativePoseFactor with first estimates. Parameters: T_odom_from (7),
/// T_odom_to (7).
class PoseCorrectionFactor final : public ceres::SizedCostFunction<6, 7, 7> {
 public:
  explicit PoseCorrectionFactor(const Correction::RelativePose& correction,
                                const PoseParameters* first_from = nullptr,
                                const PoseParameters* first_to = nullptr);
  bool Evaluate(const double* const* parameters,
                double* residuals,
                double** jacobians) const override;

 private:
  RelativePoseFactor factor_;
  const PoseParameters* first_from_;
  const PoseParameters* first_to_;
};

}  // namespace fleetloc
