#pragma once

#include <optional>
#include <span>

#include "shared/model/camera.hpp"
#include "shared/model/observation.hpp"

namespace fleetloc {

/// A camera pose and its observation of a landmark.
struct LandmarkView {
  Pose T_odom_body;
  StereoObservation observation;
};

struct TriangulationLimits {
  double min_disparity_px = 0.0;  ///< of a stereo pair, or of the parallax between two views
  double max_depth_m = 0.0;       ///< from the newest view
};

/// p_odom [m], from the stereo pair with the largest disparity, or without one from the rays of all
/// views; then refined over all views. Nothing if a limit is violated.
std::optional<Eigen::Vector3d> triangulate(std::span<const LandmarkView> views,
                                           const RectifiedStereo& stereo,
                                           const TriangulationLimits& limits);

/// p_body [m], from one stereo pair with disparity > 0.
Eigen::Vector3d triangulate(const StereoObservation& observation, const RectifiedStereo& stereo);

}  // namespace fleetloc
