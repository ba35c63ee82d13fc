#include "cloud/localizer/rejection.hpp"

namespace fleetloc {

using enum Rejection;

std::string_view name(Rejection rejection) {
  switch (rejection) {
    case kSearching:
      return "searching";
    case kAmbiguous:
      return "ambiguous";
    case kTooFewKeyframes:
      return "too_few_keyframes";
    case kNotCovered:
      return "not_covered";
    case kTooFewMatches:
      return "too_few_matches";
    case kDisagreement:
      return "disagreement";
    case kRecentDisagreement:
      return "recent_disagreement";
    case kNotSolved:
      return "not_solved";
    case kNotSettled:
      return "not_settled";
    case kPoorFit:
      return "poor_fit";
    case kBelowGround:
      return "below_ground";
    case kInnovation:
      return "innovation";
    case kSingular:
      return "singular";
    case kWeak:
      return "weak";
    case kUnconfirmed:
      return "unconfirmed";
  }
  return "unknown";
}

// What passes the checks of a place and is not certain yet speaks for it.
PlaceEvidence evidence_of(Rejection rejection) {
  switch (rejection) {
    case kTooFewMatches:
    case kDisagreement:
    case kRecentDisagreement:
    case kNotSettled:
    case kPoorFit:
    case kInnovation:
      return PlaceEvidence::kAgainst;
    case kSingular:
    case kWeak:
    case kUnconfirmed:
      return PlaceEvidence::kFor;
    case kSearching:
    case kAmbiguous:
    case kTooFewKeyframes:
    case kNotCovered:
    case kNotSolved:
    case kBelowGround:
      return PlaceEvidence::kNone;
  }
  return PlaceEvidence::kNone;
}

LocalizationStatus status_of(Rejection rejection) {
  switch (rejection) {
    case kSearching:
      return LocalizationStatus::kSearching;
    case kAmbiguous:
      return LocalizationStatus::kAmbiguous;
    case kTooFewKeyframes:
      return LocalizationStatus::kTooFewKeyframes;
    case kNotCovered:
      return LocalizationStatus::kNoMapCoverage;
    case kTooFewMatches:
    case kDisagreement:
    case kRecentDisagreement:
      return LocalizationStatus::kTooFewMatches;
    case kNotSolved:
    case kNotSettled:
    case kInnovation:
      return LocalizationStatus::kNotConverged;
    case kPoorFit:
    case kBelowGround:
      return LocalizationStatus::kPoorFit;
    case kSingular:
    case kWeak:
      return LocalizationStatus::kDegenerate;
    case kUnconfirmed:
      return LocalizationStatus::kUnconfirmed;
  }
  return LocalizationStatus::kNotConverged;
}

}  // namespace fleetloc
