#pragma once

#include <set>
#include <vector>

#include "shared/core/ids.hpp"
#include "shared/model/observation.hpp"

namespace fleetloc {

/// Tracks of moving points, or wrong ones: they stay out of the window for as long as they last.
class OutlierTracks {
 public:
  /// @param outliers  found in `frame`; landmarks that it does not observe any more are forgotten
  void add(const std::vector<LandmarkId>& outliers, const TrackedFrame& frame);

  [[nodiscard]] TrackedFrame removed_from(TrackedFrame frame) const;

  void clear() { landmarks_.clear(); }

 private:
  std::set<LandmarkId> landmarks_;
};

}  // namespace fleetloc
