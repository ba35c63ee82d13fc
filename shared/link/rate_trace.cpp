#include "shared/link/rate_trace.hpp"

#include <algorithm>
#include <cassert>
#include <iterator>

namespace fleetloc {

HeldRate rate_at(const RateTrace& trace, Duration elapsed) {
  assert(!trace.steps.empty() && elapsed >= Duration::zero());
  const Duration period = from_seconds(trace.repeat_s);
  const Duration phase = period > Duration::zero() ? elapsed % period : elapsed;
  const auto next = std::ranges::upper_bound(
      trace.steps, phase, {}, [](const RateStep& step) { return from_seconds(step.time_s); });
  const double rate = next == trace.steps.begin() ? 0.0 : std::prev(next)->bytes_per_s;
  if (next != trace.steps.end()) return {rate, elapsed - phase + from_seconds(next->time_s)};
  if (period > Duration::zero()) return {rate, elapsed - phase + period};
  return {rate, Duration::max()};
}

}  // namespace fleetloc
