#include "shared/link/random_delay.hpp"

#include <cmath>

#include "shared/link/random_streams.hpp"

namespace fleetloc {

RandomDelay::RandomDelay(const DelayConfig& config, std::uint64_t seed)
    : config_(config), random_(seed, kDelayStream) {}

Duration RandomDelay::of(std::uint64_t datagram, std::uint64_t copy) const {
  double delay_s = config_.delay_s;
  delay_s -= config_.jitter_s * std::log(random_.uniform(datagram, 2 * copy));
  const bool is_late = random_.uniform(datagram, 2 * copy + 1) < config_.reordering;
  if (is_late) delay_s += config_.reordering_delay_s;
  return from_seconds(delay_s);
}

}  // namespace fleetloc
