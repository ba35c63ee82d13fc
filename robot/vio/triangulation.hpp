#pragma once

#include <optional>
#include <span>

#include "shared/model/camera.hpp"
#include "shared/model/observation.hpp"

namespace fleetloc {

/// One sight of a landmark.
struct Sight {
  Pose T_odom_body;
  StereoObservation observation;
};

struct TriangulationLimits {
  double min_disparity_px = 0.0;  ///< of a stereo pair, or of the parallax between two sights
  double max_depth_m = 0.0;       ///< from the newest sight
};

/// From the stereo pair with the largest disparity; without one from the rays of all sights. Then
/// refined over all of them. Nothing where the geometry is too weak.
std::optional<Eigen::Vector3d> triangulate(std::span<const Sight> sights,
                                           const RectifiedStereo& stereo,
                                           const TriangulationLimits& limits);

/// Of one stereo pair with disparity > 0, in the body frame.
Eigen::Vector3d triangulate(const StereoObservation& observation, const RectifiedStereo& stereo);

}  // namespace fleetloc
