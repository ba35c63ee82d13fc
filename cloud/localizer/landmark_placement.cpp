#include "cloud/localizer/landmark_placement.hpp"

#include <algorithm>

namespace fleetloc {
namespace {

constexpr double kMinDisparity = 0.5;  // smaller ones only bound the depth [px]
constexpr double kMinDepth = 0.05;     // [m]

struct StereoView {
  const StereoObservation* observation = nullptr;
  const Pose* T_map_body = nullptr;
};

Eigen::Vector3d triangulated(const StereoView& view, const RectifiedStereo& stereo) {
  const StereoObservation& seen = *view.observation;
  const double depth =
      stereo.focal_px * stereo.baseline_m / std::max(seen.disparity, kMinDisparity);
  const Eigen::Vector2d ray = (seen.left - stereo.center_px) / stereo.focal_px;
  const Eigen::Vector3d p_cam0(depth * ray.x(), depth * ray.y(), depth);
  return *view.T_map_body * (stereo.T_body_cam0 * p_cam0);
}

}  // namespace

LandmarkPositions placed_landmarks(const SessionDatabase& database,
                                   const std::map<KeyframeId, Pose>& poses,
                                   const RectifiedStereo& stereo) {
  std::map<LandmarkId, StereoView> nearest;
  for (const auto& [id, T_map_body] : poses) {
    for (const StereoObservation& seen : database.keyframe(id).item.observations) {
      StereoView& closest = nearest[seen.landmark];
      if (closest.observation == nullptr || seen.disparity > closest.observation->disparity) {
        closest = {&seen, &T_map_body};
      }
    }
  }
  LandmarkPositions positions;
  for (const auto& [id, view] : nearest) {
    const SessionDatabase::Landmark& known = database.landmarks().at(id);
    const auto reference = known.estimate ? poses.find(known.estimate->keyframe) : poses.end();
    if (known.p_map) {
      positions[id] = *known.p_map;
    } else if (reference != poses.end()) {
      positions[id] = reference->second * known.estimate->p_body;
    } else if (view.observation->disparity > 0.0) {
      positions[id] = triangulated(view, stereo);
    }
  }
  return positions;
}

Eigen::Matrix3d position_information(const StereoObservation& observation,
                                     const RectifiedStereo& stereo,
                                     const Pose& T_cam0_map,
                                     const Eigen::Vector3d& p_map,
                                     double pixel_sigma_px) {
  const Eigen::Vector3d p_cam0 = T_cam0_map * p_map;
  if (p_cam0.z() < kMinDepth) return Eigen::Matrix3d::Zero();
  const double scale = stereo.focal_px / (p_cam0.z() * pixel_sigma_px);
  const Eigen::Vector2d ray = p_cam0.head<2>() / p_cam0.z();
  Eigen::Matrix3d J = Eigen::Matrix3d::Zero();  // u_left, v, u_right by p_cam0
  J.row(0) << scale, 0.0, -scale * ray.x();
  J.row(1) << 0.0, scale, -scale * ray.y();
  if (observation.disparity > 0.0) {
    J.row(2) << scale, 0.0, -scale * (ray.x() - stereo.baseline_m / p_cam0.z());
  }
  const Eigen::Matrix3d J_map = J * T_cam0_map.R.toRotationMatrix();
  return J_map.transpose() * J_map;
}

}  // namespace fleetloc
