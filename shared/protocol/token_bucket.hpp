#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>

#include "shared/core/time.hpp"

namespace fleetloc {

/// Bytes that may be sent: they come at a rate, and some are saved up.
class TokenBucket {
 public:
  explicit TokenBucket(double burst_bytes) : burst_bytes_(burst_bytes), tokens_(burst_bytes) {}

  /// Adds what has come since the last call.
  void advance(Timestamp now, double bytes_per_s) {
    const double elapsed_s = now_ ? std::max(0.0, to_seconds(now - *now_)) : 0.0;
    now_ = now;
    if (tokens_ >= burst_bytes_) return;
    tokens_ = std::min(burst_bytes_, tokens_ + bytes_per_s * elapsed_s);
  }

  [[nodiscard]] bool allows(std::size_t bytes) const {
    return static_cast<double>(bytes) <= tokens_;
  }
  void spend(std::size_t bytes) { tokens_ -= static_cast<double>(bytes); }

  /// Bytes on top of what is saved up; of several grants that were not used the last one counts.
  void grant(std::size_t bytes) {
    const auto granted = static_cast<double>(bytes);
    tokens_ = std::min(tokens_, burst_bytes_) + granted;
  }
  [[nodiscard]] bool exceeds_burst() const { return tokens_ > burst_bytes_; }

 private:
  double burst_bytes_;
  double tokens_;
  std::optional<Timestamp> now_;
};

}  // namespace fleetloc
