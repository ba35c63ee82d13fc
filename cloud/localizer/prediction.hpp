#pragma once

#include "cloud/localizer/dead_reckoning.hpp"
#include "cloud/localizer/landmark_placement.hpp"
#include "cloud/localizer/pose_with_covariance.hpp"

namespace fleetloc {

/// Where the window should be, before it is matched with the map.
struct Prediction {
  PosePrior prior;            ///< of one of its keyframes, by all that is known: where to look
  PosePrior before;           ///< by what was known without this window, to be optimized with it
  PoseWithCovariance newest;  ///< of its newest keyframe, dead-reckoned
  double gate_m = 0.0;        ///< its landmarks should be this close to the map
  bool is_rough = false;      ///< too far to match landmarks one by one: align the window first
  bool is_start = false;      ///< nothing was localized before: it all comes from the start pose
  bool is_early = false;      ///< all that was localized before is in the window
  bool is_found = false;      ///< is_start or is_early, and a search has found that place
};

/// Standard deviation of the landmarks' places in the map that follows from that of the pose [m].
double landmark_sigma(const LandmarkPositions& positions, const PoseWithCovariance& estimate);

}  // namespace fleetloc
