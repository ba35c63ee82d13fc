#pragma once

#include <cstddef>
#include <optional>

#include "shared/link/rate_trace.hpp"

namespace fleetloc {

/// Sends one datagram after the other at a limited rate, behind a finite queue that drops what does
/// not fit.
class Bottleneck {
 public:
  /// @param bytes_per_s  0: unlimited
  /// @param trace        where there is one as well, the smaller rate counts
  Bottleneck(double bytes_per_s, RateTrace trace, std::size_t queue_bytes);

  /// When a datagram that comes at `now` has been sent; nothing if it is dropped.
  /// @param now  since the trace began, not before that of the last call
  std::optional<Duration> departure(Duration now, std::size_t bytes);

 private:
  [[nodiscard]] double waiting_bytes(Duration now) const;
  [[nodiscard]] std::optional<Duration> sent(Duration start, std::size_t bytes) const;

  RateTrace trace_;  // empty: unlimited
  double queue_bytes_;
  Duration free_{};  // when all that is queued has been sent
};

}  // namespace fleetloc
