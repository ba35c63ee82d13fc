#include "robot/fusion/answer_outcome.hpp"

namespace fleetloc {

std::string_view name(FusionRejection reason) {
  switch (reason) {
    case FusionRejection::kNotFinite:
      return "not_finite";
    case FusionRejection::kBadCovariance:
      return "bad_covariance";
    case FusionRejection::kNotLocalized:
      return "not_localized";
    case FusionRejection::kWrongSession:
      return "wrong_session";
    case FusionRejection::kWrongMap:
      return "wrong_map";
    case FusionRejection::kTooOld:
      return "too_old";
    case FusionRejection::kUnknownStamp:
      return "unknown_stamp";
    case FusionRejection::kDuplicate:
      return "duplicate";
    case FusionRejection::kOlderThanApplied:
      return "older_than_applied";
    case FusionRejection::kGated:
      return "gated";
    case FusionRejection::kImplausibleTilt:
      return "implausible_tilt";
    case FusionRejection::kBeforeImu:
      return "before_imu";
  }
  return "unknown";
}

std::string_view name(const AnswerOutcome& outcome) {
  if (!outcome) return name(outcome.error());
  return *outcome == AnswerEffect::kRestarted ? "restarted" : "applied";
}

}  // namespace fleetloc
