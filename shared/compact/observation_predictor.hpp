#pragma once

#include <cstddef>
#include <vector>

#include "shared/compact/compact_submap.hpp"
#include "shared/compact/strict_pose.hpp"
#include "shared/model/camera.hpp"

namespace fleetloc {

/// A landmark within one sample: its last observation, and its disparity there as far as all
/// earlier ones tell it.
struct LandmarkTrack {
  CompactSubmap::Observation last;
  std::size_t keyframe = 0;  ///< index of that observation
  double disparity = 0.0;    ///< [pixel steps]; 0: no depth yet
  int seen = 0;              ///< observations
  std::size_t misses = 0;    ///< keyframes since that did not observe it

  [[nodiscard]] std::size_t seen_class() const {
    return static_cast<std::size_t>(seen < 3 ? seen : 3) - 1;
  }

  /// @param expected_disparity  what was predicted from the others; 0 if nothing was
  void add(const CompactSubmap::Observation& observation,
           std::size_t index,
           double expected_disparity);
};

struct PredictedObservation {
  int u = 0, v = 0;        ///< [pixel steps]
  double disparity = 0.0;  ///< [pixel steps]; 0: no depth is known
};

/// Where a landmark should be seen next. The tracker follows a patch from image to image, so its
/// errors add up like a random walk: the last pixel with an averaged depth predicts better than a
/// point that all observations agree on.
class ObservationPredictor {
 public:
  /// @param bodies  poses of the keyframes
  ObservationPredictor(const RectifiedStereo& stereo,
                       std::uint32_t step_bits,
                       const std::vector<StrictPose>& bodies);

  [[nodiscard]] PredictedObservation predict(const LandmarkTrack& track, std::size_t index) const;

  /// Pixels are below it [pixel steps].
  [[nodiscard]] int max_steps() const { return max_steps_; }

  /// Principal point [pixel steps].
  [[nodiscard]] int center_u() const { return rounded(center_u_, 0, max_steps_); }
  [[nodiscard]] int center_v() const { return rounded(center_v_, 0, max_steps_); }

 private:
  double focal_, center_u_, center_v_, baseline_;  // [pixel steps; m]
  int max_steps_;
  std::vector<StrictPose> cameras_;
};

}  // namespace fleetloc
