#pragma once

#include <string_view>

namespace fleetloc {

/// Why the robot's end of the protocol does not use a well-formed message, or cannot send one.
enum class MessageRefusal {
  kNotEncodable,      ///< out of range of the wire type
  kOtherSession,      ///< of this robot, or of another one
  kOtherLocalizer,    ///< than the chosen one
  kOtherIncarnation,  ///< of the chosen localizer
  kNotAsked,          ///< no such submap was sent
  kOtherMap,          ///< than the one that this robot's poses refer to
  kForeignWriter,     ///< another program speaks for this localizer, see SenderBinding
};

/// Name in summary.json.
std::string_view name(MessageRefusal refusal);

}  // namespace fleetloc
