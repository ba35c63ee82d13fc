#pragma once

#include <optional>

#include "shared/core/time.hpp"

namespace fleetloc {

class ConfigReader;

/// When a status message is sent: soon after it has changed, and otherwise seldom, so that whoever
/// only waits costs next to nothing.
class StatusTimer {
 public:
  struct Config {
    double interval_s{};      ///< while nothing changes
    double min_interval_s{};  ///< however often it changes
  };
  explicit StatusTimer(const Config& config) : config_(config) {}

  /// True if it is to be sent now. Counts it as sent.
  /// @param has_changed  since it was sent last
  bool due(Timestamp now, bool has_changed);

  /// There is a new receiver: it is due at once.
  void reset() { sent_.reset(); }

 private:
  Config config_;
  std::optional<Timestamp> sent_;
};

/// Reads `interval_s` and `min_interval_s`.
StatusTimer::Config read_status_timer_config(ConfigReader config);

}  // namespace fleetloc
