#pragma once

// Works around: Fast DDS 2.9.1 sends the heartbeats of a writer to all readers as long as one of
// them has not acknowledged everything. A discovery server that is down makes each client ask the
// other one three times a second, which answers each time: 660 bytes a second.
// Delete when: heartbeats go to those only who have something to acknowledge.

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <set>
#include <utility>

#include "shared/transport/workarounds/silent_server_pacing.hpp"

namespace fleetloc {

/// Knows which samples discovery servers have acknowledged, and which heartbeats tell them nothing.
///
/// No clock, no I/O. Any thread may use any function; without servers none waits.
class AnsweredHeartbeats {
 public:
  /// Sets the servers and their addresses; drops all earlier observations.
  void watch(const ServerLocators& servers);

  /// @param datagram  that has arrived, well-formed RTPS
  void observe(RtpsBytes datagram);

  /// True if the datagram is a heartbeat, and the server at its destination has acknowledged all
  /// that it announces.
  [[nodiscard]] bool includes(RtpsBytes datagram, const PeerAddressFilter::Locator& destination);

 private:
  using Writer = std::pair<GuidPrefix, std::uint32_t>;  // of this participant, for that server

  std::atomic<bool> is_watching_ = false;
  std::mutex mutex_;
  ServerLocators servers_;                       // guarded by mutex_
  std::map<Writer, std::int64_t> acknowledged_;  // up to this sample; guarded by mutex_
};

}  // namespace fleetloc
