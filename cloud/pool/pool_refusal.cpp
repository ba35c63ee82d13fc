#include "cloud/pool/pool_refusal.hpp"

#include "shared/protocol/session_register.hpp"

namespace fleetloc {

std::string_view name(PoolRefusal refusal) {
  switch (refusal) {
    case PoolRefusal::kUnknownSession:
      return name(SessionRefusal::kUnknown);
    case PoolRefusal::kOutdatedSession:
      return name(SessionRefusal::kOutdated);
    case PoolRefusal::kConflictingSession:
      return name(SessionRefusal::kConflict);
    case PoolRefusal::kForeignWriter:
      return "foreign_writer";
    case PoolRefusal::kOtherIncarnation:
      return "other_incarnation";
    case PoolRefusal::kTooManySessions:
      return "too_many_sessions";
    case PoolRefusal::kSeenBefore:
      return "seen_before";
    case PoolRefusal::kOvertaken:
      return "overtaken";
    case PoolRefusal::kStale:
      return "stale";
    case PoolRefusal::kError:
      return "error";
    case PoolRefusal::kTooMuchMemory:
      return "too_much_memory";
    case PoolRefusal::kNotEncodable:
      return "not_encodable";
  }
  return "unknown";
}

}  // namespace fleetloc
