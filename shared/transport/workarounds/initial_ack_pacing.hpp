#pragma once

// Works around: a reader of Fast DDS 2.9.1 acknowledges a new writer 14 times a second until it has
// heard a heartbeat of it. Each of these costs 92 bytes, encrypted 148, and discovery alone has
// three such readers for every participant: 4 KB/s, for as long as the other side is not heard or
// does not hear, and 24 KB where an answer takes 6 s. Delete when: the library waits longer from
// one to the next.

#include <array>
#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>

#include "shared/transport/workarounds/rtps_message.hpp"

namespace fleetloc {

/// Spaces out the acknowledgements with which a reader asks for the first heartbeat of a writer:
/// those of sequence number 0, which acknowledge nothing. The first is sent at once, the others
/// after pauses that double. What else repeats the question, the heartbeats of a writer that has
/// samples, goes on as before.
///
/// Of encrypted ones only the length can be seen, and with which key. So those are spaced out that
/// follow each other as the questions do, whatever they acknowledge; who misses one for it sends
/// another heartbeat.
///
/// No clock, no I/O. Any thread may use any function.
class InitialAckPacing {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// False for an acknowledgement that is to be left out.
  /// @param datagram  that Fast DDS sends
  bool passes(RtpsBytes datagram, Time now);

 private:
  using Bytes20 = std::array<std::uint8_t, 20>;  // participant that is asked, reader, writer
  struct Asked {
    Time asked_at;  // by the library, passed or not
    Time due_at;
    std::chrono::steady_clock::duration pause;
  };

  std::mutex mutex_;
  std::map<Bytes20, Asked> questions_;  // guarded by mutex_
};

}  // namespace fleetloc
