#pragma once

#include <vector>

#include <Eigen/Core>

#include "shared/core/ids.hpp"
#include "shared/core/time.hpp"

namespace fleetloc {

/// Observation of a landmark in the rectified stereo pair [px].
struct StereoObservation {
  LandmarkId landmark{};
  Eigen::Vector2d left = Eigen::Vector2d::Zero();  ///< u, v
  double disparity = 0.0;  ///< u_left - u_right > 0; 0: not seen by the right camera
};

/// The observations of one stereo frame.
struct TrackedFrame {
  Timestamp stamp;
  std::vector<StereoObservation> observations;  ///< strictly increasing by landmark
};

}  // namespace fleetloc
