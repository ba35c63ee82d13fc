#include "deploy/evaluation/errors/alignment.hpp"

#include <cmath>

#include <Eigen/Geometry>

namespace fleetloc {
namespace {

struct Centers {
  Eigen::Vector3d truth = Eigen::Vector3d::Zero();
  Eigen::Vector3d estimate = Eigen::Vector3d::Zero();
};

Centers centers(std::span<const PosePair> pairs) {
  Centers sum;
  for (const PosePair& pair : pairs) {
    sum.truth += pair.T_truth_body.p;
    sum.estimate += pair.T_estimate_body.p;
  }
  const auto count = static_cast<double>(pairs.size());
  return {.truth = sum.truth / count, .estimate = sum.estimate / count};
}

/// Sum of truth * estimate^T about the centers.
Eigen::Matrix3d correlation(std::span<const PosePair> pairs, const Centers& center) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const PosePair& pair : pairs) {
    sum += (pair.T_truth_body.p - center.truth) *
           (pair.T_estimate_body.p - center.estimate).transpose();
  }
  return sum;
}

Eigen::Quaterniond about_z(double angle_rad) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ()));
}

/// The rotation and translation of Umeyama (1991), without scale.
Pose least_squares(std::span<const PosePair> pairs) {
  Eigen::Matrix3Xd estimate(3, static_cast<Eigen::Index>(pairs.size()));
  Eigen::Matrix3Xd truth(3, estimate.cols());
  for (Eigen::Index i = 0; i < estimate.cols(); ++i) {
    const PosePair& pair = pairs[static_cast<std::size_t>(i)];
    estimate.col(i) = pair.T_estimate_body.p;
    truth.col(i) = pair.T_truth_body.p;
  }
  const Eigen::Matrix4d T = Eigen::umeyama(estimate, truth, false);
  return {.R = Eigen::Quaterniond(Eigen::Matrix3d(T.topLeftCorner<3, 3>())),
          .p = T.topRightCorner<3, 1>()};
}

}  // namespace

Pose align(std::span<const PosePair> pairs, Alignment alignment) {
  if (alignment == Alignment::kNone || pairs.empty()) return {};
  if (alignment == Alignment::kSe3) return least_squares(pairs);
  const Centers center = centers(pairs);
  const Eigen::Matrix3d C = correlation(pairs, center);
  const Eigen::Quaterniond R = about_z(std::atan2(C(1, 0) - C(0, 1), C(0, 0) + C(1, 1)));
  return {.R = R, .p = center.truth - R * center.estimate};
}

Pose align_first(std::span<const PosePair> pairs) {
  if (pairs.empty()) return {};
  const PosePair& first = pairs.front();
  // The heading that brings the estimated attitude as near to the true one as a turn about z can.
  const Eigen::Matrix3d R =
      (first.T_truth_body.R * first.T_estimate_body.R.inverse()).toRotationMatrix();
  const Eigen::Quaterniond yaw = about_z(std::atan2(R(1, 0) - R(0, 1), R(0, 0) + R(1, 1)));
  return {.R = yaw, .p = first.T_truth_body.p - yaw * first.T_estimate_body.p};
}

}  // namespace fleetloc
