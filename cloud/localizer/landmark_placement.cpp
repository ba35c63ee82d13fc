#include "cloud/localizer/landmark_placement.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace fleetloc {
namespace {

constexpr double kMinDisparity = 0.5;  // smaller ones only bound the depth [px]
constexpr double kMinDepth = 0.05;     // [m]

constexpr int kIterations = 5;
constexpr double kConverged = 1e-3;  // of the distance to the camera

struct StereoView {
  const StereoObservation* observation;
  const Pose* T_map_cam0;
};

/// Of u_left, v and u_right, the last one zero without a disparity [px].
struct StereoResidual {
  Eigen::Vector3d r = Eigen::Vector3d::Zero();  // measured - predicted
  Eigen::Matrix3d J = Eigen::Matrix3d::Zero();  // of the prediction, by p_cam0
};

/// Nothing behind the camera or too close to it.
std::optional<StereoResidual> residual_of(const StereoObservation& seen,
                                          const RectifiedStereo& stereo,
                                          const Eigen::Vector3d& p_cam0) {
  if (p_cam0.z() < kMinDepth) return std::nullopt;
  StereoResidual residual;
  const double scale = stereo.focal_px / p_cam0.z();
  const Eigen::Vector2d ray = p_cam0.head<2>() / p_cam0.z();
  residual.r.head<2>() = seen.left - stereo.center_px - stereo.focal_px * ray;
  residual.J.row(0) << scale, 0.0, -scale * ray.x();
  residual.J.row(1) << 0.0, scale, -scale * ray.y();
  if (seen.disparity > 0.0) {
    residual.r.z() = residual.r.x() - seen.disparity + scale * stereo.baseline_m;
    residual.J.row(2) << scale, 0.0, -scale * (ray.x() - stereo.baseline_m / p_cam0.z());
  }
  return residual;
}

Eigen::Vector3d triangulated(const StereoView& view, const RectifiedStereo& stereo) {
  const StereoObservation& seen = *view.observation;
  const double depth =
      stereo.focal_px * stereo.baseline_m / std::max(seen.disparity, kMinDisparity);
  const Eigen::Vector2d ray = (seen.left - stereo.center_px) / stereo.focal_px;
  const Eigen::Vector3d p_cam0(depth * ray.x(), depth * ray.y(), depth);
  return *view.T_map_cam0 * p_cam0;
}

/// Least squares of all views. The view with the largest disparity alone is often the one with the
/// largest error of it, and puts the landmark too near.
/// @return  nothing if they do not agree on a point before the cameras
std::optional<Eigen::Vector3d> refined(Eigen::Vector3d p_map,
                                       const std::vector<StereoView>& views,
                                       const RectifiedStereo& stereo) {
  for (int i = 0; i < kIterations; ++i) {
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    double nearest_m = std::numeric_limits<double>::max();
    for (const StereoView& view : views) {
      const Pose T_cam0_map = inverse(*view.T_map_cam0);
      const Eigen::Vector3d p_cam0 = T_cam0_map * p_map;
      const auto residual = residual_of(*view.observation, stereo, p_cam0);
      if (!residual) return std::nullopt;
      const Eigen::Matrix3d J_map = residual->J * T_cam0_map.R.toRotationMatrix();
      H += J_map.transpose() * J_map;
      g += J_map.transpose() * residual->r;
      nearest_m = std::min(nearest_m, p_cam0.norm());
    }
    const Eigen::Vector3d step = H.ldlt().solve(g);
    if (!step.allFinite()) return std::nullopt;
    p_map += step;
    if (step.norm() < kConverged * nearest_m) return p_map;
  }
  return std::nullopt;
}

/// The one in which the landmark is nearest.
const StereoView& nearest_of(const std::vector<StereoView>& views) {
  return *std::ranges::max_element(
      views, {}, [](const StereoView& view) { return view.observation->disparity; });
}

}  // namespace

LandmarkPositions placed_landmarks(const SessionDatabase& database,
                                   const std::map<KeyframeId, Pose>& poses,
                                   const RectifiedStereo& stereo) {
  std::map<LandmarkId, std::vector<StereoView>> views_of;
  std::map<KeyframeId, Pose> T_map_cam0;
  for (const auto& [id, T_map_body] : poses) {
    const Pose& camera = T_map_cam0[id] = T_map_body * stereo.T_body_cam0;
    for (const StereoObservation& seen : database.keyframe(id).item.observations) {
      views_of[seen.landmark].push_back({&seen, &camera});
    }
  }
  LandmarkPositions positions;
  for (const auto& [id, views] : views_of) {
    const SessionDatabase::Landmark& known = database.landmarks().at(id);
    const auto reference = known.estimate ? poses.find(known.estimate->keyframe) : poses.end();
    if (known.p_map) {
      positions[id] = *known.p_map;
    } else if (reference != poses.end()) {
      positions[id] = reference->second * known.estimate->p_body;
    } else if (const StereoView& nearest = nearest_of(views);
               nearest.observation->disparity > 0.0) {
      const Eigen::Vector3d p_map = triangulated(nearest, stereo);
      positions[id] = refined(p_map, views, stereo).value_or(p_map);
    }
  }
  return positions;
}

Eigen::Matrix3d position_information(const StereoObservation& observation,
                                     const RectifiedStereo& stereo,
                                     const Pose& T_cam0_map,
                                     const Eigen::Vector3d& p_map,
                                     double pixel_sigma_px) {
  const auto residual = residual_of(observation, stereo, T_cam0_map * p_map);
  if (!residual) return Eigen::Matrix3d::Zero();
  const Eigen::Matrix3d J_map = residual->J * T_cam0_map.R.toRotationMatrix() / pixel_sigma_px;
  return J_map.transpose() * J_map;
}

}  // namespace fleetloc
