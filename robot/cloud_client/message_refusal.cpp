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
    case MessageRefusal::kForeignWriter:
      return "foreign_writer";
  }
  return "unknown";
}

}  // namespace fleetloc
