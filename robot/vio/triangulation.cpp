#include "robot/vio/triangulation.hpp"

#include <array>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "shared/factors/reprojection_factor.hpp"

namespace fleetloc {
namespace {

constexpr double kMinDepth = 0.1;  // [m]
constexpr int kRefinements = 3;

Eigen::Vector3d ray(const StereoObservation& observation, const RectifiedStereo& stereo) {
  Eigen::Vector3d ray;
  ray << (observation.left - stereo.center_px) / stereo.focal_px, 1.0;
  return ray;
}

double depth(const LandmarkView& view,
             const RectifiedStereo& stereo,
             const Eigen::Vector3d& p_odom) {
  return (inverse(view.T_odom_body * stereo.T_body_cam0) * p_odom).z();
}

// The point nearest to all rays. The smallest eigenvalue of the sum of projectors is about half
// the squared angle between two rays.
std::optional<Eigen::Vector3d> intersect(std::span<const LandmarkView> views,
                                         const RectifiedStereo& stereo,
                                         double min_parallax_px) {
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (const LandmarkView& view : views) {
    const Pose T_odom_cam0 = view.T_odom_body * stereo.T_body_cam0;
    const Eigen::Vector3d d = (T_odom_cam0.R * ray(view.observation, stereo)).normalized();
    const Eigen::Matrix3d P = Eigen::Matrix3d::Identity() - d * d.transpose();
    A += P;
    b += P * T_odom_cam0.p;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(A);
  const double min_angle = min_parallax_px / stereo.focal_px;
  if (eigen.eigenvalues()(0) < 0.5 * min_angle * min_angle) {
    return std::nullopt;
  }
  return A.ldlt().solve(b);
}

std::optional<Eigen::Vector3d> first_guess(std::span<const LandmarkView> views,
                                           const RectifiedStereo& stereo,
                                           const TriangulationLimits& limits) {
  const LandmarkView* best = nullptr;
  for (const LandmarkView& view : views) {
    if (view.observation.disparity >= limits.min_disparity_px &&
        (best == nullptr || view.observation.disparity > best->observation.disparity)) {
      best = &view;
    }
  }
  if (best != nullptr) {
    return best->T_odom_body * triangulate(best->observation, stereo);
  }
  return views.size() > 1 ? intersect(views, stereo, limits.min_disparity_px) : std::nullopt;
}

// Gauss-Newton over the reprojection errors, poses fixed.
Eigen::Vector3d refined_point(std::span<const LandmarkView> views,
                              const RectifiedStereo& stereo,
                              Eigen::Vector3d p_odom) {
  for (int i = 0; i < kRefinements; ++i) {
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    for (const LandmarkView& view : views) {
      const PoseParameters pose = to_parameters(view.T_odom_body);
      const std::array<const double*, 2> parameters{pose.data(), p_odom.data()};
      Eigen::Vector3d r = Eigen::Vector3d::Zero();
      Eigen::Matrix<double, 3, 3, Eigen::RowMajor> J;
      J.setZero();
      std::array<double*, 2> jacobians{nullptr, J.data()};
      if (view.observation.disparity > 0.0) {
        StereoReprojectionFactor(view.observation, stereo, {})
            .Evaluate(parameters.data(), r.data(), jacobians.data());
      } else {
        MonoReprojectionFactor(view.observation, stereo, {})
            .Evaluate(parameters.data(), r.data(), jacobians.data());
      }
      H += J.transpose() * J;
      g += J.transpose() * r;
    }
    p_odom -= H.ldlt().solve(g);
  }
  return p_odom;
}

}  // namespace

Eigen::Vector3d triangulate(const StereoObservation& observation, const RectifiedStereo& stereo) {
  const double z = stereo.focal_px * stereo.baseline_m / observation.disparity;
  return stereo.T_body_cam0 * (z * ray(observation, stereo));
}

std::optional<Eigen::Vector3d> triangulate(std::span<const LandmarkView> views,
                                           const RectifiedStereo& stereo,
                                           const TriangulationLimits& limits) {
  std::optional<Eigen::Vector3d> p_odom = first_guess(views, stereo, limits);
  if (!p_odom.has_value()) {
    return std::nullopt;
  }
  if (views.size() > 1) {
    p_odom = refined_point(views, stereo, *p_odom);
  }
  for (const LandmarkView& view : views) {
    const double z = depth(view, stereo, *p_odom);
    if (!(z > kMinDepth && z < limits.max_depth_m)) {
      return std::nullopt;
    }
  }
  return p_odom;
}

}  // namespace fleetloc
