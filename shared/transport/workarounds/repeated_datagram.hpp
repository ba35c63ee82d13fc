#pragma once

// Works around: nothing: what discovery_queue and repetition_copies tell datagrams apart by.
// Delete when: those are deleted.

#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

#include "shared/transport/workarounds/peer_address_filter.hpp"
#include "shared/transport/workarounds/rtps_message.hpp"

namespace fleetloc {

/// A datagram that Fast DDS sends again until it is answered: of built-in endpoints, or what
/// reliable ones say to each other.
struct RepeatedDatagram {
  /// What it is about: of two that are about the same, to one destination, the later one says all
  /// that the earlier one does.
  std::vector<std::uint8_t> subject;
  /// What it says: all but how often it was said.
  std::vector<std::uint8_t> statement;
  /// After which it may be worth saying again.
  std::chrono::milliseconds worth_repeating_after{};
  /// Of built-in endpoints alone.
  bool is_discovery = true;
  /// Of an authentication: as long as dozens of others, and answered by one as long.
  bool is_handshake = false;
  /// Of DDS Security: only for who has announced himself already.
  bool is_secure = false;

  /// Nothing for all others: samples of best effort, and what is encrypted.
  static std::optional<RepeatedDatagram> read(RtpsBytes datagram);
  /// Of one that is encrypted only lengths and keys can be seen. One with a sample is about nothing
  /// else; those without, heartbeats and acknowledgements, are about the same if their key is, and
  /// all say the same.
  /// @param datagram  of built-in endpoints
  /// @return nothing if it is not encrypted
  static std::optional<RepeatedDatagram> read_encrypted(RtpsBytes datagram);

  /// Where to: what goes elsewhere is about something else.
  /// @param socket  only tells those of one socket from those of another
  void address_to(const void* socket, const PeerAddressFilter::Locator& to);
};

}  // namespace fleetloc
