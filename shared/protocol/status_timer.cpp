#include "shared/protocol/status_timer.hpp"

#include "shared/config/config_reader.hpp"

namespace fleetloc {

bool StatusTimer::due(Timestamp now, bool has_changed) {
  const double interval_s = has_changed ? config_.min_interval_s : config_.interval_s;
  if (sent_ && to_seconds(now - *sent_) < interval_s) return false;
  sent_ = now;
  return true;
}

StatusTimer::Config read_status_timer_config(ConfigReader config) {
  return {.interval_s = config.positive("interval_s"),
          .min_interval_s = config.positive("min_interval_s")};
}

}  // namespace fleetloc
