#include "robot/vio/pose_alignment.hpp"

#include <array>

#include "shared/factors/reprojection_factor.hpp"

namespace fleetloc {
namespace {

template <typename Factor, int Rows>
void add(const KnownPoint& point,
         const RectifiedStereo& stereo,
         const PoseParameters& pose,
         const RobustKernel& kernel,
         PoseSystem& system) {
  const Factor factor(point.observation, stereo, {point.pixel_sigma});
  const std::array<const double*, 2> parameters{pose.data(), point.p_odom.data()};
  Eigen::Matrix<double, Rows, 1> r;
  Eigen::Matrix<double, Rows, 7, Eigen::RowMajor> J_ambient;
  std::array<double*, 2> jacobians{J_ambient.data(), nullptr};
  factor.Evaluate(parameters.data(), r.data(), jacobians.data());
  const double norm = r.norm();
  if (norm > kernel.outlier_sigmas) {
    system.outliers.push_back(point.observation.landmark);
    return;
  }
  const double weight = norm > kernel.huber_sigmas ? kernel.huber_sigmas / norm : 1.0;
  const auto J = J_ambient.template leftCols<6>();
  system.H.noalias() += weight * J.transpose() * J;
  system.g.noalias() += weight * J.transpose() * r;
  ++system.inliers;
}

}  // namespace

PoseSystem linearize(std::span<const KnownPoint> points,
                     const RectifiedStereo& stereo,
                     const Pose& T_odom_body,
                     const RobustKernel& kernel) {
  const PoseParameters pose = to_parameters(T_odom_body);
  PoseSystem system;
  for (const KnownPoint& point : points) {
    if (point.observation.disparity > 0.0) {
      add<StereoReprojectionFactor, 3>(point, stereo, pose, kernel, system);
    } else {
      add<MonoReprojectionFactor, 2>(point, stereo, pose, kernel, system);
    }
  }
  return system;
}

}  // namespace fleetloc
