#pragma once

// Works around: Fast DDS 2.9.1 sends each datagram to every address that a participant announces,
// so a host with several networks is sent it several times.
// Delete when: the library picks one reachable locator for each remote participant.

#include <chrono>
#include <compare>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <span>

#include "shared/transport/workarounds/rtps_message.hpp"

namespace fleetloc {

/// Selects the address of a participant that its datagrams come from. Fast DDS sends to every
/// address that a participant announces: a localizer's computer has one in each of its networks,
/// and often one of a local bridge, and each would cost a robot's uplink once more.
///
/// No clock, no I/O. Any thread may use any function.
class PeerAddressFilter {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// IPv4, in any one byte order.
  struct Locator {
    std::uint32_t address = 0;
    std::uint32_t port = 0;
    auto operator<=>(const Locator&) const = default;  // NOLINT(modernize-use-nullptr)
  };

  /// A participant announces a locator.
  void announced(const GuidPrefix& participant, const Locator& locator, Time now);
  /// Whether the participant has announced the locator.
  [[nodiscard]] bool is_of(const GuidPrefix& participant, const Locator& locator) const;
  /// A datagram of a participant came from that address.
  void heard(const GuidPrefix& participant, std::uint32_t address, Time now);

  /// True if each participant that announces the locator has lately been heard from another of its
  /// announced addresses, and that is among `destinations`, those of the same datagram.
  [[nodiscard]] bool is_redundant(const Locator& locator,
                                  std::span<const Locator> destinations,
                                  Time now) const;

 private:
  struct Participant {
    std::set<std::uint32_t> addresses;  // announced
    Time announced_at;
    std::optional<std::uint32_t> source;
    Time heard_at;

    [[nodiscard]] Time last() const;  // sign of life
  };

  mutable std::mutex mutex_;
  std::map<GuidPrefix, Participant> participants_;      // guarded by mutex_
  std::map<Locator, std::set<GuidPrefix>> announcers_;  // guarded by mutex_
};

}  // namespace fleetloc
