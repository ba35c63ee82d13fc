#include "shared/link/bottleneck.hpp"

#include <algorithm>
#include <utility>

namespace fleetloc {

Bottleneck::Bottleneck(double bytes_per_s, RateTrace trace, std::size_t queue_bytes)
    : trace_(std::move(trace)), queue_bytes_(static_cast<double>(queue_bytes)) {
  if (bytes_per_s <= 0.0) return;
  if (trace_.steps.empty()) trace_.steps = {{.time_s = 0.0, .bytes_per_s = bytes_per_s}};
  for (RateStep& step : trace_.steps) step.bytes_per_s = std::min(step.bytes_per_s, bytes_per_s);
}

std::optional<Duration> Bottleneck::departure(Duration now, std::size_t bytes) {
  if (trace_.steps.empty()) return now;
  if (waiting_bytes(now) + static_cast<double>(bytes) > queue_bytes_) return std::nullopt;
  const std::optional<Duration> departure = sent(std::max(now, free_), bytes);
  if (departure) free_ = *departure;
  return departure;
}

// What passes between now and when the bottleneck is free.
double Bottleneck::waiting_bytes(Duration now) const {
  double bytes = 0.0;
  while (now < free_) {
    const HeldRate rate = rate_at(trace_, now);
    const Duration end = std::min(free_, rate.until);
    bytes += to_seconds(end - now) * rate.bytes_per_s;
    now = end;
  }
  return bytes;
}

// Nothing if the trace stays at zero.
std::optional<Duration> Bottleneck::sent(Duration start, std::size_t bytes) const {
  auto left = static_cast<double>(bytes);
  for (;;) {
    const HeldRate rate = rate_at(trace_, start);
    const bool is_last = rate.until == Duration::max();
    const double passing = is_last ? left : to_seconds(rate.until - start) * rate.bytes_per_s;
    if (rate.bytes_per_s > 0.0 && left <= passing) {
      return start + from_seconds(left / rate.bytes_per_s);
    }
    if (is_last) return std::nullopt;
    left -= passing;
    start = rate.until;
  }
}

}  // namespace fleetloc
