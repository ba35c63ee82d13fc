#pragma once

// Makes up for: Fast DDS 2.9.1 does not notice that a discovery server with the same GUID was
// started again within its lease, and ignores what the new one says.
// Delete when: a restarted server is recognized, e.g. by a GUID of its own for each start.

#include <chrono>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <utility>

#include "shared/transport/workarounds/rtps_message.hpp"

namespace fleetloc {

/// Notices that a participant which always has the same GUID, as a discovery server has, was
/// started again: the heartbeats of its writers count from one. Fast DDS does not notice within
/// the lease. It takes what the new one says for what the old one had said, up to as many samples
/// as that had sent, and hears of nobody who comes meanwhile.
///
/// No clock, no I/O.
class ServerRestartDetector {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// Of those to watch; what was seen before is forgotten.
  void watch(const std::set<GuidPrefix>& participants);

  /// @param datagram  well-formed RTPS
  void observe(std::span<const std::uint8_t> datagram, Time now);

  /// One of them was started again since watch().
  [[nodiscard]] bool has_restarted() const { return has_restarted_; }

 private:
  struct Heartbeat {
    std::uint32_t count = 0;
    Time at;
  };

  std::set<GuidPrefix> participants_;
  std::map<std::pair<GuidPrefix, std::uint32_t>, Heartbeat> latest_;  // by participant and writer
  bool has_restarted_ = false;
};

}  // namespace fleetloc
