#include "shared/model/localization_result.hpp"
#include "shared/model/pose_estimate.hpp"

namespace fleetloc {

std::string_view name(LocalizationStatus status) {
  switch (status) {
    case LocalizationStatus::kLocalized:
      return "localized";
    case LocalizationStatus::kNeedFull:
      return "need_full";
    case LocalizationStatus::kSearching:
      return "searching";
    case LocalizationStatus::kTooFewKeyframes:
      return "too_few_keyframes";
    case LocalizationStatus::kNoMapCoverage:
      return "no_map_coverage";
    case LocalizationStatus::kTooFewMatches:
      return "too_few_matches";
    case LocalizationStatus::kNotConverged:
      return "not_converged";
    case LocalizationStatus::kPoorFit:
      return "poor_fit";
    case LocalizationStatus::kDegenerate:
      return "degenerate";
    case LocalizationStatus::kUnconfirmed:
      return "unconfirmed";
    case LocalizationStatus::kLost:
      return "lost";
    case LocalizationStatus::kAmbiguous:
      return "ambiguous";
  }
  return "unknown";
}

std::string_view name(Quality quality) {
  switch (quality) {
    case Quality::kInitializing:
      return "initializing";
    case Quality::kLocalized:
      return "localized";
    case Quality::kDeadReckoning:
      return "dead_reckoning";
    case Quality::kLost:
      return "lost";
    case Quality::kSearching:
      return "searching";
  }
  return "unknown";
}

}  // namespace fleetloc
