#pragma once

// Works around: Fast DDS 2.9.1 sends to every address that a participant announces, those without
// a route too.
// Delete when: with has_route() in network_addresses.hpp.

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>

#include "shared/transport/workarounds/network_addresses.hpp"

namespace fleetloc {

/// Remembers which addresses have a route: to ask the kernel costs three system calls, several
/// times what else is done for a datagram. An answer is good for a second: a new route is used, and
/// one that is gone noticed, a second later at most. (A change of addresses is noticed at once: it
/// recreates the participant, and this with it.)
///
/// No clock. Any thread may use any function.
class RouteCache {
 public:
  using Clock = std::chrono::steady_clock;
  using Lookup = std::function<bool(std::uint32_t address)>;

  /// @param lookup  asks the kernel; another one in tests
  explicit RouteCache(Lookup lookup = fleetloc::has_route) : lookup_(std::move(lookup)) {}

  /// @param address  IPv4, its first byte the highest
  bool has_route(std::uint32_t address, Clock::time_point now);

 private:
  struct Answer {
    bool has_route = false;
    Clock::time_point at;
  };

  Lookup lookup_;
  std::mutex mutex_;                         // not held while the kernel is asked
  std::map<std::uint32_t, Answer> answers_;  // by address; guarded by mutex_
};

}  // namespace fleetloc
