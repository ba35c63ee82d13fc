#pragma once

// Works around: Fast DDS 2.9.1 announces itself to a discovery server that does not answer twice a
// second, sends it heartbeats thrice a second and acknowledgements 14 times: 2.7 KB/s for each
// server that is down.
// Delete when: the library waits longer from one try to the next.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <set>

#include "shared/transport/workarounds/peer_address_filter.hpp"
#include "shared/transport/workarounds/rtps_message.hpp"

namespace fleetloc {

/// The addresses of discovery servers.
using ServerLocators = std::map<GuidPrefix, std::set<PeerAddressFilter::Locator>>;

/// Asks discovery servers that are silent ever more seldom. What goes to one passes for half a
/// second, and then not during a pause that doubles: up to 8 s while none is heard, up to a minute
/// while another one is there. A server that is heard has all its datagrams again.
///
/// No clock, no I/O. Any thread may use any function; without servers none waits.
class SilentServerPacing {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Locator = PeerAddressFilter::Locator;

  /// Sets the servers and their addresses; drops all earlier observations.
  void watch(const ServerLocators& servers);

  /// A datagram of a participant has arrived.
  void heard(const GuidPrefix& participant, Time now);

  /// False if a datagram to there is to be left out.
  bool passes(const Locator& destination, Time now);

 private:
  struct Server {
    std::set<Locator> locators;
    Time heard_at{};
    Time open_until{};
    Time opens_at{};
    std::chrono::steady_clock::duration pause{};
  };
  [[nodiscard]] bool is_another_there(const GuidPrefix& than, Time now) const;

  std::atomic<bool> is_watching_ = false;
  std::mutex mutex_;
  std::map<GuidPrefix, Server> servers_;  // guarded by mutex_
};

}  // namespace fleetloc
