#include "shared/protocol/retransmission_timer.hpp"

#include <algorithm>
#include <chrono>

#include "shared/config/config_reader.hpp"

namespace fleetloc {

bool RetransmissionTimer::due(Timestamp now, double loss) {
  if (!last_) return false;
  const double share = std::clamp(loss / config_.full_rate_loss, 0.0, 1.0);
  const double interval_s =
      config_.max_interval_s + share * (config_.min_interval_s - config_.max_interval_s);
  if (to_seconds(now - *last_) < interval_s) return false;
  last_ = now;
  return true;
}

RetransmissionTimer::Config read_retransmission_timer_config(ConfigReader config) {
  return {.max_interval_s = config.positive("max_interval_s"),
          .min_interval_s = config.positive("min_interval_s"),
          .full_rate_loss = config.positive("full_rate_loss")};
}

}  // namespace fleetloc
