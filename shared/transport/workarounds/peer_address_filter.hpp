#pragma once

// Makes up for: Fast DDS 2.9.1 sends each datagram to every address that a participant announces,
// so a host with several networks is sent it several times.
// Delete when: the library picks one reachable locator for each remote participant.

#include <chrono>
#include <compare>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>

#include "shared/transport/workarounds/rtps_message.hpp"

namespace fleetloc {

/// Which of a participant's addresses it is heard from. Fast DDS sends to every address that a
/// participant announces: a localizer's computer has one in each of its networks, and often that of
/// a bridge of its own, which would cost a robot's uplink as often.
///
/// No clock, no I/O.
class PeerAddressFilter {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// IPv4, in any one byte order.
  struct Place {
    std::uint32_t address = 0;
    std::uint32_t port = 0;
    auto operator<=>(const Place&) const = default;
  };

  /// A participant says that it can be reached there.
  void announced(const GuidPrefix& participant, const Place& place, Time now);
  /// A datagram of a participant came from that address.
  void heard(const GuidPrefix& participant, std::uint32_t address, Time now);

  /// Everyone who might be meant is known, has lately been heard from another address that it
  /// announces, and is reached there by another one of these destinations of the same datagram.
  [[nodiscard]] bool is_superfluous(const Place& place,
                                    std::span<const Place> destinations,
                                    Time now) const;

 private:
  struct Participant {
    std::set<std::uint32_t> addresses;  // announced
    Time announced_at;
    std::optional<std::uint32_t> source;
    Time heard_at;

    [[nodiscard]] Time last() const;  // sign of it
  };

  std::map<GuidPrefix, Participant> participants_;
  std::map<Place, std::set<GuidPrefix>> claims_;
};

}  // namespace fleetloc
