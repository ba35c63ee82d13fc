#include "shared/transport/traffic_counter.hpp"

#include "shared/link/datagrams.hpp"

namespace fleetloc {

// Counters order nothing else in memory.
constexpr auto kRelaxed = std::memory_order_relaxed;

void TrafficCounter::Direction::add(std::uint32_t each, std::uint64_t count) {
  bytes.fetch_add(count * (each + kIpUdpBytes), kRelaxed);
  datagrams.fetch_add(count, kRelaxed);
}

void TrafficCounter::sent(std::uint32_t bytes, std::uint64_t copies) {
  sent_.add(bytes, copies);
}

void TrafficCounter::received(std::uint32_t bytes) {
  received_.add(bytes, 1);
}

WireTraffic TrafficCounter::total() const {
  return {.sent_bytes = sent_.bytes.load(kRelaxed),
          .received_bytes = received_.bytes.load(kRelaxed),
          .sent_datagrams = sent_.datagrams.load(kRelaxed),
          .received_datagrams = received_.datagrams.load(kRelaxed)};
}

}  // namespace fleetloc
