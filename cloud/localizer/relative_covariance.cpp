#include "cloud/localizer/relative_covariance.hpp"

#include <algorithm>
#include <utility>

#include <Eigen/LU>

#include "shared/geometry/so3.hpp"

namespace fleetloc {

PoseCovariances::PoseCovariances(Eigen::MatrixXd covariance, int first)
    : covariance_(std::move(covariance)), first_(first) {}

Matrix6d PoseCovariances::of_relative_pose(int a, int b, const Pose& T_a_b) const {
  const Matrix6d A = adjoint(inverse(T_a_b));
  const Matrix6d cross = A * block(a, b);
  return block(b, b) - cross - cross.transpose() + A * block(a, a) * A.transpose();
}

// The landmark follows the poses that observe it: p_map moves by -H^-1 C^T d_pose with each, where
// C is the coupling of both in the normal equations. Around that it has the covariance H^-1.
Eigen::Matrix3d PoseCovariances::of_anchored_landmark(const WindowSystem::Landmark& landmark,
                                                      const Eigen::Matrix3d& H,
                                                      const Pose& T_map_anchor) const {
  using Rows3 = Eigen::Matrix<double, 3, Eigen::Dynamic>;
  const Eigen::Matrix3d R_anchor_map = T_map_anchor.R.toRotationMatrix().transpose();
  const Eigen::Matrix3d own = R_anchor_map * H.inverse();
  Eigen::Index begin =
      covariance_.rows() - 6;  // the observers, mostly without gaps, and the anchor
  for (const auto& seen : landmark.equations.couplings) begin = std::min(begin, at(seen.kept));
  Rows3 J = Rows3::Zero(3, covariance_.rows() - begin);
  for (const auto& seen : landmark.equations.couplings) {
    J.middleCols<6>(at(seen.kept) - begin).noalias() -= own * seen.H.transpose();
  }
  const Eigen::Vector3d p_anchor = inverse(T_map_anchor) * landmark.p_map;
  J.rightCols<6>().leftCols<3>() += hat(p_anchor);
  J.rightCols<3>() -= Eigen::Matrix3d::Identity();
  const Rows3 spread = J * covariance_.bottomRightCorner(J.cols(), J.cols());
  const Eigen::Matrix3d covariance = spread * J.transpose() + own * R_anchor_map.transpose();
  return 0.5 * (covariance + covariance.transpose());
}

}  // namespace fleetloc
