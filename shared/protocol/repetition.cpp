#include "shared/protocol/repetition.hpp"

#include <algorithm>
#include <chrono>

#include "shared/config/config_reader.hpp"

namespace fleetloc {

bool Repetition::due(Timestamp now, double loss) {
  if (!last_) return false;
  const double share = std::clamp(loss / config_.full_rate_loss, 0.0, 1.0);
  const double interval_s = config_.slowest_interval_s +
                            share * (config_.fastest_interval_s - config_.slowest_interval_s);
  if (to_seconds(now - *last_) < interval_s) return false;
  last_ = now;
  return true;
}

Repetition::Config read_repetition_config(ConfigReader config) {
  return {.slowest_interval_s = config.positive("slowest_interval_s"),
          .fastest_interval_s = config.positive("fastest_interval_s"),
          .full_rate_loss = config.positive("full_rate_loss")};
}

}  // namespace fleetloc
