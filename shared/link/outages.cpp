#include "shared/link/outages.hpp"

#include <algorithm>

namespace fleetloc {
namespace {

bool is_within(Duration elapsed, const Outage& outage) {
  const Duration start = from_seconds(outage.from_s);
  return elapsed >= start && elapsed < start + from_seconds(outage.for_s);
}

bool is_within(Duration elapsed, const PeriodicOutage& outage) {
  const Duration since_first = elapsed - from_seconds(outage.from_s);
  if (outage.every_s <= 0.0 || since_first < Duration::zero()) return false;
  return since_first % from_seconds(outage.every_s) < from_seconds(outage.for_s);
}

}  // namespace

bool is_out(const Outages& outages, Duration elapsed) {
  return is_within(elapsed, outages.periodic) ||
         std::ranges::any_of(outages.at,
                             [&](const Outage& outage) { return is_within(elapsed, outage); });
}

}  // namespace fleetloc
