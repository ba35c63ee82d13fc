#include "cloud/localizer/localization_diagnostics.hpp"

#include <algorithm>

namespace fleetloc {

LocalizationDiagnostics diagnostics_of(const std::vector<KeyframeId>& window) {
  LocalizationDiagnostics result;
  result.keyframes = static_cast<int>(window.size());
  return result;
}

LocalizationDiagnostics diagnostics_of(const std::vector<KeyframeId>& window,
                                       const Prediction& prediction,
                                       const MapFit& fit) {
  const Association& association = fit.association;
  LocalizationDiagnostics result = diagnostics_of(window);
  result.gate_m = prediction.gate_m;
  result.is_aligned = prediction.is_rough;
  result.eligible = association.eligible;
  result.covered = association.covered;
  result.level = association.level;
  result.occluded = association.occluded;
  result.below_ground = association.below_ground;
  result.matches = static_cast<int>(association.matches.size());
  result.planar_matches =
      static_cast<int>(std::ranges::count_if(association.matches, &MapMatch::is_planar));
  result.rounds = fit.rounds;
  result.iterations = fit.iterations;
  result.cost = fit.cost;
  result.median_residual = fit.median_residual;
  result.innovation_sigmas = fit.innovation_sigmas;
  result.map_sigmas_m = fit.constraint.sigmas_m;
  return result;
}

}  // namespace fleetloc
