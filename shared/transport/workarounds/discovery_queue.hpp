#pragma once

// Works around: the flow controllers of Fast DDS 2.9.1 leave out the built-in endpoints, and these
// answer each heartbeat with a request, and each request with everything that is missing and a
// heartbeat for every sample of it. Where an answer takes longer than the pause between two
// heartbeats, the rounds overlap and multiply: over 4 KB/s, 0.5 s each way and 10 % of loss a
// localizer offered 19 KB/s for as long as it ran, and no robot found it.
// Delete when: built-in endpoints have a flow controller, and repeat nothing that is on its way.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <vector>

#include "shared/transport/workarounds/repeated_datagram.hpp"

namespace fleetloc {

/// Datagrams of discovery that wait, so that there are at most so many bytes of them a second. Of
/// those about the same only the newest waits, in the place of the first; what has just been said
/// is left out. What is of DDS Security goes before the rest: it concerns those who are known
/// already.
///
/// No clock, no I/O. Any thread may use any function.
class DiscoveryQueue {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// @param bytes_per_s  on the wire
  explicit DiscoveryQueue(double bytes_per_s) : bytes_per_s_(bytes_per_s) {}

  /// True if it has been said just now, and has nothing to add.
  [[nodiscard]] bool has_just_said(const RepeatedDatagram& datagram, Time now);

  /// True if it may be sent at once, since nothing waits. Counts it.
  bool passes(const RepeatedDatagram& datagram, std::size_t bytes, Time now);

  /// @param datagram  that knows where it is sent
  /// @param bytes     on the wire
  /// @return when take() is to be called, unless such a call is due already
  std::optional<Time> put(RepeatedDatagram datagram,
                          std::size_t bytes,
                          std::function<void()> send,
                          Time now);

  struct Taken {
    std::function<void()> send;  ///< empty: there is nothing
    std::optional<Time> next;    ///< when take() is to be called again
  };
  Taken take(Time now);

 private:
  struct Waiting {
    RepeatedDatagram datagram;
    std::size_t bytes = 0;
    std::function<void()> send;
  };

  std::deque<Waiting>::iterator behind_secure();
  void sent(const RepeatedDatagram& datagram, std::size_t bytes, Time now);

  const double bytes_per_s_;
  std::mutex mutex_;
  std::deque<Waiting> waiting_;                           // guarded by mutex_
  std::map<std::vector<std::uint8_t>, Time> said_until_;  // by statement; guarded by mutex_
  Time free_at_{};                                        // guarded by mutex_
  bool is_due_ = false;                                   // a call of take(); guarded by mutex_
};

}  // namespace fleetloc
