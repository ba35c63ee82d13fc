#include "robot/cloud_client/message_refusal.hpp"

namespace fleetloc {

std::string_view name(MessageRefusal refusal) {
  switch (refusal) {
    case MessageRefusal::kNotEncodable:
      return "not_encodable";
    case MessageRefusal::kOtherSession:
      return "other_session";
    case MessageRefusal::kOtherLocalizer:
      return "other_localizer";
    case MessageRefusal::kOtherIncarnation:
      return "other_incarnation";
    case MessageRefusal::kNotAsked:
      return "not_asked";
    case MessageRefusal::kOtherMap:
      return "other_map";
    case MessageRefusal::kCorrectionOfOtherSession:
      return "correction_of_other_session";
    case MessageRefusal::kCorrectionOfOtherLocalizer:
      return "correction_of_other_localizer";
    case MessageRefusal::kCorrectionOfOtherIncarnation:
      return "correction_of_other_incarnation";
    case MessageRefusal::kOutdatedCorrection:
      return "outdated_correction";
  }
  return "unknown";
}

}  // namespace fleetloc
