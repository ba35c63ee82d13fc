#pragma once

// Works around: Fast DDS 2.9.1 repeats what was lost one datagram at a time, that of its built-in
// endpoints once a second, and a match takes several that follow from each other: a heartbeat, a
// request, its answer, in each direction. Where 70 % are lost, all three arrive once in 37 s.
// Delete when: the library repeats more often, the more is lost.

#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <vector>

#include "shared/transport/workarounds/peer_address_filter.hpp"
#include "shared/transport/workarounds/repeated_datagram.hpp"

namespace fleetloc {

/// Says in how many copies a datagram of discovery or of reliable endpoints is sent: the more, the
/// more often the library has to repeat itself at the same destination. What is repeated for
/// seconds is lost, not late; from then on each repetition is answered with half as many copies
/// again, and each new statement with fewer, so that the library repeats everything about once,
/// whatever the loss. Who gets several of one drops all but the first, and answers once.
///
/// Each destination has a budget of bytes for copies: enough for a match where nine of ten are
/// lost, and little after it. What goes on being repeated for long is for somebody who is not
/// there: it is sent once again, and no longer counts.
///
/// No clock, no I/O. Any thread may use any function.
class RepetitionCopies {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Locator = PeerAddressFilter::Locator;

  /// @param max_copies  at least one
  explicit RepetitionCopies(int max_copies) : max_copies_(max_copies) {}

  /// @param datagram  that knows where it is sent
  /// @param to        where
  /// @param bytes     on the wire
  /// @return at least one
  int copies(const RepeatedDatagram& datagram, const Locator& to, std::size_t bytes, Time now);

 private:
  struct Said {
    Time first{};
    Time last{};
    int times = 0;
  };
  struct Destination {
    double copies = 1.0;
    double bytes_left = 0.0;  // for more than one
    Time last{};
  };

  Destination& destination(const Locator& to, Time now);

  const int max_copies_;
  std::mutex mutex_;
  std::map<std::vector<std::uint8_t>, Said> said_;  // by statement; guarded by mutex_
  std::map<Locator, Destination> destinations_;     // guarded by mutex_
};

}  // namespace fleetloc
