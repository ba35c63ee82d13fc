#include "robot/odometry/outlier_tracks.hpp"

namespace fleetloc {

void OutlierTracks::add(const std::vector<LandmarkId>& outliers, const TrackedFrame& frame) {
  std::set<LandmarkId> tracked;
  for (const StereoObservation& seen : frame.observations) tracked.insert(seen.landmark);
  std::erase_if(landmarks_, [&](LandmarkId id) { return !tracked.contains(id); });
  landmarks_.insert(outliers.begin(), outliers.end());
}

TrackedFrame OutlierTracks::removed_from(TrackedFrame frame) const {
  std::erase_if(frame.observations, [this](const StereoObservation& seen) {
    return landmarks_.contains(seen.landmark);
  });
  return frame;
}

}  // namespace fleetloc
