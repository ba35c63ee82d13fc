#pragma once

#include <cstdint>

#include "shared/core/counter_random.hpp"
#include "shared/core/time.hpp"

namespace fleetloc {

/// How long a datagram takes behind the bottleneck.
struct DelayConfig {
  double delay_s{};             ///< of every datagram
  double jitter_s{};            ///< mean of an exponential extra delay
  double reordering{};          ///< share of the datagrams that take longer
  double reordering_delay_s{};  ///< how much longer
};

/// Draws the delay of each datagram by itself, so that a late one is overtaken by those behind it.
/// Of the extra delay by jitter, which is exponential, `jitter_s` is the mean, the standard
/// deviation, and the mean difference between two datagrams (the jitter of RFC 3550).
class RandomDelay {
 public:
  RandomDelay(const DelayConfig& config, std::uint64_t seed);

  /// @param datagram  its number
  /// @param copy      of it: each has a delay of its own
  [[nodiscard]] Duration of(std::uint64_t datagram, std::uint64_t copy = 0) const;

 private:
  DelayConfig config_;
  CounterRandom random_;
};

}  // namespace fleetloc
