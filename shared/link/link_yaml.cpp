#include "shared/core/exact_text.hpp"
#include "shared/link/link_config.hpp"

namespace fleetloc {
namespace {

std::string pair_text(double first, double second) {
  return "[" + exact_text(first) + ", " + exact_text(second) + "]";
}

std::string list_text(const auto& items, const auto& text_of) {
  std::string text;
  for (const auto& item : items) text += (text.empty() ? "" : ", ") + text_of(item);
  return "[" + text + "]";
}

std::string trace_yaml(const RateTrace& trace) {
  const auto step = [](const RateStep& each) { return pair_text(each.time_s, each.bytes_per_s); };
  return ", rate_trace: " + list_text(trace.steps, step) +
         ", rate_trace_repeat_s: " + exact_text(trace.repeat_s);
}

std::string outages_yaml(const Outages& outages) {
  std::string yaml;
  if (!outages.at.empty()) {
    const auto outage = [](const Outage& each) { return pair_text(each.from_s, each.for_s); };
    yaml += ", outages: " + list_text(outages.at, outage);
  }
  const PeriodicOutage& periodic = outages.periodic;
  if (periodic.every_s > 0.0) {
    yaml += ", periodic_outage: {every_s: " + exact_text(periodic.every_s) +
            ", from_s: " + exact_text(periodic.from_s) + ", for_s: " + exact_text(periodic.for_s) +
            "}";
  }
  return yaml;
}

std::string direction_yaml(const LinkDirection& direction) {
  const LinkDirection defaults;
  std::string yaml = "{loss: " + exact_text(direction.loss) +
                     ", delay_s: " + exact_text(direction.delay_s) +
                     ", rate_bytes_per_s: " + exact_text(direction.rate_bytes_per_s) +
                     ", queue_bytes: " + std::to_string(direction.queue_bytes);
  const auto add = [&](const char* key, double LinkDirection::*value) {
    if (direction.*value == defaults.*value) return;
    yaml += std::string(", ") + key + ": " + exact_text(direction.*value);
  };
  add("burst_length", &LinkDirection::burst_length);
  add("jitter_s", &LinkDirection::jitter_s);
  add("reordering", &LinkDirection::reordering);
  add("reordering_delay_s", &LinkDirection::reordering_delay_s);
  add("duplication", &LinkDirection::duplication);
  if (!direction.rate_trace.steps.empty()) yaml += trace_yaml(direction.rate_trace);
  return yaml + outages_yaml(direction.outages) + "}\n";
}

}  // namespace

std::string link_yaml(const LinkConfig& link) {
  return "seed: " + std::to_string(link.seed) + "\nuplink: " + direction_yaml(link.uplink) +
         "downlink: " + direction_yaml(link.downlink);
}

}  // namespace fleetloc
