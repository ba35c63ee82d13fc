#pragma once

// Works around: Fast DDS 2.9.1 sends each message of an authentication to everybody whom it has
// discovered, though it is for one, and everybody else drops it. With two localizers and two robots
// a robot sent the 4.4 KB of each message twice, and heard it as often for the other robot.
// Delete when: the library sends it to that participant only.

#include <optional>

#include "shared/transport/workarounds/rtps_message.hpp"

namespace fleetloc {

/// A message with which participants authenticate each other (DDS Security 1.1, chapter 7.4.3).
struct HandshakeMessage {
  GuidPrefix receiver{};  ///< whom it is for
  RtpsBytes content;      ///< the same in all its repetitions, which have numbers of their own

  /// Nothing if there is none in the datagram, or one that is incomplete.
  static std::optional<HandshakeMessage> read(const RtpsSubmessage& submessage);
};

/// Whether it brings a participant the handshake message of another one.
/// @param datagram  that Fast DDS sends
bool is_handshake_for_another(RtpsBytes datagram);

}  // namespace fleetloc
