#pragma once

// Works around: Fast DDS 2.9.1 does not notice that a discovery server with the same GUID was
// restarted within its lease. It ignores the samples of one that starts from nothing, and the
// heartbeats of one that goes on from its backup, since they count from one again.
// Delete when: a restarted server is recognized, e.g. by a GUID of its own for each start.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "shared/transport/workarounds/rtps_message.hpp"

namespace fleetloc {

/// Detects the restart of a participant that always has the same GUID, as a discovery server has:
/// the heartbeats of its writers count from one again. If the sequence numbers that they announce
/// begin again, too, Fast DDS takes the new one's samples for duplicates, up to those of the old
/// one, and does not discover anybody who joins meanwhile: its participant must be made anew. A
/// server with a backup goes on with its sequence numbers; it is enough to go on with its counts.
///
/// No clock, no I/O. Any thread may use any function; without participants to watch none waits.
class ServerRestartDetector {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// Sets the participants to watch; drops all earlier observations.
  void watch(const std::set<GuidPrefix>& participants);

  /// @param datagram  well-formed RTPS
  /// @return what to take in its place, if heartbeats in it must count higher
  std::optional<std::vector<std::uint8_t>> observe(std::span<const std::uint8_t> datagram,
                                                   Time now);

  /// One of them was restarted since watch(), and has forgotten everybody.
  [[nodiscard]] bool has_restarted() const { return has_restarted_; }

 private:
  struct Heartbeat {
    std::uint32_t count = 0;
    std::int64_t last_sample = 0;
    Time at;
    std::uint32_t counted_before = 0;  // by its predecessors
  };

  /// Returns what its count must be raised by.
  std::uint32_t observe(const GuidPrefix& from, RtpsFields heartbeat, Time now);

  std::atomic<bool> is_watching_ = false;
  std::atomic<bool> has_restarted_ = false;
  std::mutex mutex_;
  std::set<GuidPrefix> participants_;                                 // guarded by mutex_
  std::map<std::pair<GuidPrefix, std::uint32_t>, Heartbeat> latest_;  // by participant and writer;
                                                                      // guarded by mutex_
};

}  // namespace fleetloc
