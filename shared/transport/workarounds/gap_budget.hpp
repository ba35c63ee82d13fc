#pragma once

// Works around: Fast DDS 2.9.1 keeps each number that a GAP tells of and that lies ahead of what
// has arrived: 64 bytes for each, and a datagram of 64 bytes tells of a million (CVE-2025-64438).
// Delete when: the library keeps ranges, or refuses what no writer can have left out.

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>

#include "shared/transport/workarounds/rtps_message.hpp"

namespace fleetloc {

/// Bounds how many samples one writer may say that there are not: 2^20, and as many again over a
/// day. A reader that does not get a GAP goes on by the writer's next heartbeat.
///
/// No clock, no I/O. Any thread may use any function; only a GAP waits.
class GapBudget {
 public:
  using Clock = std::chrono::steady_clock;
  using Time = Clock::time_point;
  static constexpr double kNumbers = 1 << 20;

  /// @param datagram  well-formed, see check_rtps()
  /// @return false if it is to be dropped
  bool passes(RtpsBytes datagram, Time now);

 private:
  using Guid = std::array<std::uint8_t, 16>;
  struct Writer {
    double left = kNumbers;
    Time seen_at{};
  };

  bool spend(const Guid& writer, double numbers, Time now);

  std::mutex mutex_;
  std::map<Guid, Writer> writers_;  // guarded by mutex_
};

}  // namespace fleetloc
