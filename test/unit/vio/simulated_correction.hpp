#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "deploy/sim/room/simulated_run.hpp"
#include "robot/vio/window_estimate.hpp"
#include "robot/vio/window_graph.hpp"
#include "shared/model/correction.hpp"

namespace fleetloc {

/// A correction by a map: the truth with noise of these sigmas, and its information.
struct SimulatedCloud {
  double landmark_sigma_m = 0.03;
  double rotation_sigma_rad = 2e-3;
  double translation_sigma_m = 0.01;
  bool noise = false;          ///< false: the sigmas are assumed, but no noise is drawn
  double outlier_share = 0.0;  ///< of landmarks, displaced by up to a metre along each axis
  double scale = 1.0;          ///< of the map: a bias
  std::uint64_t seed = 1;

  /// Of all keyframes and landmarks of a window, the newest keyframe the anchor.
  [[nodiscard]] Correction correction(const SimulatedRun& run, const WindowEstimate& window) const;
  [[nodiscard]] Correction correction(const SimulatedRun& run, const WindowGraph& graph) const;

 private:
  struct Keyframe {
    KeyframeId id{};
    Timestamp stamp;
  };
  [[nodiscard]] Correction correction(const SimulatedRun& run,
                                      const std::vector<Keyframe>& keyframes,
                                      const std::vector<LandmarkId>& landmarks) const;
};

}  // namespace fleetloc
