#include "shared/link/link_config.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "shared/config/delimited_file.hpp"

namespace fleetloc {
namespace {

namespace fs = std::filesystem;

constexpr double kLargestDelaySeconds = 3600.0;
constexpr double kLargestRateBytesPerSecond = 1e12;
constexpr double kLargestTimeSeconds = 1e9;
constexpr double kLongestBurst = 1e6;
constexpr int kMinQueueBytes = 1500;  // one datagram of Ethernet
constexpr int kLargestQueueBytes = 1 << 30;
constexpr double kQueueSeconds = 2.0;
constexpr std::size_t kSmallDefaultQueue = 8000;

using Pairs = std::vector<std::array<double, 2>>;

// 0 or at least 1: that far below, a datagram takes longer than any run.
bool is_rate(double value) {
  return value == 0.0 || (value >= 1.0 && value <= kLargestRateBytesPerSecond);
}

bool is_time(double value) {
  return value >= 0.0 && value <= kLargestTimeSeconds;  // false for NaN
}

Pairs pairs_of_file(ConfigReader& section, const std::string& key, const fs::path& folder) {
  try {
    DelimitedFile file(folder / section.get<std::string>(key), ',');
    Pairs pairs;
    while (file.next()) {
      file.expect_columns(2);
      pairs.push_back({file.number(0), file.number(1)});
    }
    return pairs;
  } catch (const TextFileError& error) {
    section.fail(key, error.what());
  }
}

RateTrace trace_of(const Pairs& pairs, const ConfigReader& section, const std::string& key) {
  if (pairs.empty()) section.fail(key, "is empty");
  if (pairs.front()[0] != 0.0) section.fail(key, "must begin at 0 s");
  RateTrace trace;
  for (const auto& [time_s, bytes_per_s] : pairs) {
    if (!is_time(time_s) || !is_rate(bytes_per_s)) {
      section.fail(key, "rates must be 0 (nothing passes) or 1..1e12, times 0..1e9 s");
    }
    if (!trace.steps.empty() && time_s <= trace.steps.back().time_s) {
      section.fail(key, "times must ascend");
    }
    trace.steps.push_back({.time_s = time_s, .bytes_per_s = bytes_per_s});
  }
  return trace;
}

void read_rate_trace(ConfigReader& section, const fs::path& folder, LinkDirection& direction) {
  const bool has_list = section.has("rate_trace");
  const bool has_file = section.has("rate_trace_file");
  if (has_list && has_file) section.fail("rate_trace_file", "stands beside rate_trace");
  if (!has_list && !has_file) {
    if (section.has("rate_trace_repeat_s")) section.fail("rate_trace_repeat_s", "needs a trace");
    return;
  }
  const std::string key = has_list ? "rate_trace" : "rate_trace_file";
  RateTrace trace = trace_of(
      has_list ? section.get<Pairs>(key) : pairs_of_file(section, key, folder), section, key);
  if (section.has("rate_trace_repeat_s")) {
    trace.repeat_s = section.number("rate_trace_repeat_s", 0.0, kLargestTimeSeconds);
  }
  const bool repeats = trace.repeat_s > 0.0;
  if (repeats && trace.repeat_s <= trace.steps.back().time_s) {
    section.fail("rate_trace_repeat_s", "must be 0 (the last rate holds) or behind the last step");
  }
  if (!repeats && trace.steps.back().bytes_per_s == 0.0) {
    section.fail(key, "must not end with a rate of 0, unless it repeats");
  }
  if (std::ranges::all_of(trace.steps, [](const auto& step) { return step.bytes_per_s == 0.0; })) {
    section.fail(key, "has no rate above 0");
  }
  direction.rate_trace = std::move(trace);
}

void read_outages(ConfigReader& section, Outages& outages) {
  if (section.has("outages")) {
    outages.at.clear();
    for (const auto& [from_s, for_s] : section.get<Pairs>("outages")) {
      if (!is_time(from_s) || !is_time(for_s)) section.fail("outages", "times must be in 0..1e9 s");
      outages.at.push_back({.from_s = from_s, .for_s = for_s});
    }
  }
  if (!section.has("periodic_outage")) return;
  ConfigReader periodic = section.section("periodic_outage");
  outages.periodic.every_s = periodic.number("every_s", 1e-3, kLargestTimeSeconds);
  outages.periodic.from_s = periodic.number("from_s", 0.0, kLargestTimeSeconds);
  outages.periodic.for_s = periodic.number("for_s", 0.0, outages.periodic.every_s);
}

LinkDirection read_direction(ConfigReader section, const fs::path& folder) {
  LinkDirection direction;
  direction.loss = section.number("loss", 0.0, 1.0);
  direction.delay_s = section.number("delay_s", 0.0, kLargestDelaySeconds);
  direction.rate_bytes_per_s = section.get<double>("rate_bytes_per_s");
  if (!is_rate(direction.rate_bytes_per_s)) {
    section.fail("rate_bytes_per_s", "must be 0 (unlimited) or at least 1, and at most 1e12");
  }
  read_impairments(section, folder, direction);
  const bool limited = direction.rate_bytes_per_s > 0.0 || !direction.rate_trace.steps.empty();
  direction.queue_bytes = static_cast<std::size_t>(
      section.integer("queue_bytes", limited ? kMinQueueBytes : 0, kLargestQueueBytes));
  return direction;
}

}  // namespace

LinkConfig perfect_link() {
  return {};
}

LinkConfig read_link_config(ConfigReader config, const fs::path& folder) {
  LinkConfig link;
  link.seed = config.get<std::uint64_t>("seed");
  link.uplink = read_direction(config.section("uplink"), folder);
  link.downlink = read_direction(config.section("downlink"), folder);
  config.expect_fully_read();
  return link;
}

LinkConfig read_link_file(const fs::path& file) {
  return read_link_config(ConfigReader::from_file(file), file.parent_path());
}

void read_impairments(ConfigReader& section, const fs::path& folder, LinkDirection& direction) {
  const auto read = [&](const char* key, double min, double max, double& value) {
    if (section.has(key)) value = section.number(key, min, max);
  };
  read("burst_length", 1.0, kLongestBurst, direction.burst_length);
  read("jitter_s", 0.0, kLargestDelaySeconds, direction.jitter_s);
  read("reordering", 0.0, 1.0, direction.reordering);
  read("reordering_delay_s", 0.0, kLargestDelaySeconds, direction.reordering_delay_s);
  if (direction.reordering > 0.0 && direction.reordering_delay_s <= 0.0) {
    section.fail("reordering", "needs a reordering_delay_s above 0");
  }
  read("duplication", 0.0, 1.0, direction.duplication);
  read_rate_trace(section, folder, direction);
  read_outages(section, direction.outages);
}

std::size_t default_queue_bytes(const LinkDirection& direction) {
  double rate = direction.rate_bytes_per_s;
  if (rate <= 0.0) {
    for (const RateStep& step : direction.rate_trace.steps) rate = std::max(rate, step.bytes_per_s);
  }
  return std::max(kSmallDefaultQueue, static_cast<std::size_t>(kQueueSeconds * rate));
}

}  // namespace fleetloc
