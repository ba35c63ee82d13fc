#pragma once

#include <string_view>

namespace fleetloc {

/// Why a localizer does not use a well-formed message, drops work, or cannot send an answer. The
/// first three are those of SessionRefusal.
enum class PoolRefusal {
  kUnknownSession,
  kOutdatedSession,
  kConflictingSession,
  kForeignWriter,     ///< another program speaks for this robot, see SenderBinding
  kOtherIncarnation,  ///< meant for an earlier start of this localizer
  kTooManySessions,
  kSeenBefore,     ///< a submap that came twice, or very late
  kOvertaken,      ///< more submaps wait than may
  kStale,          ///< waited for too long
  kError,          ///< the localization threw an exception
  kTooMuchMemory,  ///< the session is ended
  kNotEncodable,   ///< an answer beyond the bounds of its wire type
};

/// Name in logs and sessions.json.
std::string_view name(PoolRefusal refusal);

}  // namespace fleetloc
