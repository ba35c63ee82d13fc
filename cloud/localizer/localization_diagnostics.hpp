#pragma once

#include <optional>
#include <vector>

#include "cloud/localizer/map_fit.hpp"
#include "cloud/localizer/prediction.hpp"
#include "cloud/localizer/rejection.hpp"
#include "shared/core/ids.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// Diagnostics of one localization. What a rejection came before is zero.
struct LocalizationDiagnostics {
  std::optional<Rejection> rejection;  ///< nothing: localized
  int keyframes = 0;                   ///< in the window
  int eligible = 0;                    ///< landmarks known well enough to be matched
  int covered = 0;                     ///< of these, with the map around them
  int level = 0;                       ///< of the matches, on level surfaces
  int occluded = 0;                    ///< see Association
  int below_ground = 0;                ///< see Association
  int matches = 0;                     ///< of the landmarks, in the last round
  int planar_matches = 0;
  int rounds = 0;                            ///< of association and optimization
  int iterations = 0;                        ///< of all rounds
  double gate_m = 0.0;                       ///< see Prediction
  bool is_aligned = false;                   ///< the window was aligned as one rigid body first
  double cost = 0.0;                         ///< E_loc at the end
  double median_residual = 0.0;              ///< of the matches, in standard deviations
  double innovation_sigmas = 0.0;            ///< Mahalanobis distance from what odometry predicted
  Vector6d map_sigmas_m = Vector6d::Zero();  ///< see MapConstraint
};

/// Of a window that no stage has taken up.
LocalizationDiagnostics diagnostics_of(const std::vector<KeyframeId>& window);
/// Of a window, and of the stages that predict it and match it with the map.
LocalizationDiagnostics diagnostics_of(const std::vector<KeyframeId>& window,
                                       const Prediction& prediction,
                                       const MapFit& fit);

}  // namespace fleetloc
