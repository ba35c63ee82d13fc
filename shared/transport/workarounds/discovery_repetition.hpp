#pragma once

// Works around: the built-in endpoints of Fast DDS 2.9.1 repeat what was lost once a second, one
// datagram each time, and a match takes several that follow from each other: a heartbeat, a
// request, its answer, in each direction. Where 70 % are lost, all three arrive once in 37 s.
// Delete when: the library repeats more often, the more is lost.

#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <vector>

#include "shared/transport/workarounds/discovery_queue.hpp"

namespace fleetloc {

/// Says how often a datagram of discovery is sent: what is new once, what has to be said again and
/// again, as after losses, in ever more copies. Who gets several of one drops all but the first,
/// and answers once.
///
/// What goes on being repeated is for somebody who is not there; after some tries it is sent once
/// again, since Fast DDS repeats it to all others, too.
///
/// No clock, no I/O. Any thread may use any function.
class DiscoveryRepetition {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// @param max_copies  at least one
  explicit DiscoveryRepetition(int max_copies) : max_copies_(max_copies) {}

  /// @param datagram  that knows where it is sent
  /// @return at least one
  int copies(const DiscoveryDatagram& datagram, Time now);

 private:
  struct Said {
    int times = 0;
    Time last{};
  };

  const int max_copies_;
  std::mutex mutex_;
  std::map<std::vector<std::uint8_t>, Said> said_;  // by statement; guarded by mutex_
};

}  // namespace fleetloc
