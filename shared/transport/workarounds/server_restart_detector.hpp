#pragma once

// Works around: Fast DDS 2.9.1 does not notice that a discovery server with the same GUID was
// restarted within its lease, and ignores the samples of the new one.
// Delete when: a restarted server is recognized, e.g. by a GUID of its own for each start.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <set>
#include <span>
#include <utility>

#include "shared/transport/workarounds/rtps_message.hpp"

namespace fleetloc {

/// Detects the restart of a participant that always has the same GUID, as a discovery server has:
/// the heartbeats of its writers count from one again. Fast DDS does not notice it within the
/// lease: it takes the new one's samples for duplicates, up to the sequence number of the old one,
/// and does not discover anybody who joins meanwhile.
///
/// No clock, no I/O. Any thread may use any function; without participants to watch none waits.
class ServerRestartDetector {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// Sets the participants to watch; drops all earlier observations.
  void watch(const std::set<GuidPrefix>& participants);

  /// @param datagram  well-formed RTPS
  void observe(std::span<const std::uint8_t> datagram, Time now);

  /// One of them was restarted since watch().
  [[nodiscard]] bool has_restarted() const { return has_restarted_; }

 private:
  struct Heartbeat {
    std::uint32_t count = 0;
    Time at;
  };

  std::atomic<bool> is_watching_ = false;
  std::atomic<bool> has_restarted_ = false;
  std::mutex mutex_;
  std::set<GuidPrefix> participants_;                                 // guarded by mutex_
  std::map<std::pair<GuidPrefix, std::uint32_t>, Heartbeat> latest_;  // by participant and writer;
                                                                      // guarded by mutex_
};

}  // namespace fleetloc
