#include "shared/link/link_model.hpp"

#include <algorithm>

#include "shared/link/random_streams.hpp"

namespace fleetloc {

LinkModel::LinkModel(const LinkDirection& direction, std::uint64_t seed)
    : bottleneck_(direction.rate_bytes_per_s, direction.rate_trace, direction.queue_bytes),
      outages_(direction.outages),
      loss_(direction.loss, direction.burst_length, seed),
      delay_({.delay_s = direction.delay_s,
              .jitter_s = direction.jitter_s,
              .reordering = direction.reordering,
              .reordering_delay_s = direction.reordering_delay_s},
             seed),
      duplication_(direction.duplication),
      duplication_random_(seed, kDuplicationStream) {}

void LinkModel::start(Timestamp now) {
  if (!start_) start_ = now;
}

std::vector<Timestamp> LinkModel::arrivals(Timestamp now, std::size_t wire_bytes) {
  start(now);
  elapsed_ = std::max(elapsed_, now - *start_);
  const std::uint64_t datagram = datagrams_++;
  const bool is_lost = loss_.next();  // for each, whatever the queue does
  const std::optional<Duration> departure = bottleneck_.departure(elapsed_, wire_bytes);
  if (!departure || is_lost || is_out(outages_, *departure)) return {};
  const bool is_doubled = duplication_random_.uniform(datagram) < duplication_;
  std::vector<Timestamp> arrivals;
  for (std::uint64_t copy = 0; copy < (is_doubled ? 2U : 1U); ++copy) {
    arrivals.push_back(*start_ + *departure + delay_.of(datagram, copy));
  }
  return arrivals;
}

}  // namespace fleetloc
