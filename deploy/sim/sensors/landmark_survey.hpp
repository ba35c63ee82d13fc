#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "deploy/sim/world/ray_caster.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/model/camera.hpp"

namespace fleetloc {

/// A corner of an image and the point of the world that it shows.
struct VisibleLandmark {
  cv::Point2f pixel;
  Eigen::Vector3d p_map;
};

/// Shi-Tomasi corners of a rendered image, strongest first, at most `max_count` and 8 px apart;
/// without those of the sky.
std::vector<VisibleLandmark> visible_landmarks(const cv::Mat& gray,
                                               const RayCaster& world,
                                               const Camera& camera,
                                               const Pose& T_map_cam,
                                               int max_count);

/// The point in the world at a pixel [m]; nothing for the sky.
std::optional<Eigen::Vector3d> visible_point(const RayCaster& world,
                                             const Camera& camera,
                                             const Pose& T_map_cam,
                                             const Eigen::Vector2d& pixel);

/// Share of the landmarks without any surface of `map` within 0.3 m; 0 if there are none.
double unmapped_share(const std::vector<VisibleLandmark>& landmarks, const RayCaster& map);

}  // namespace fleetloc
