#include "shared/transport/malformed_datagrams.hpp"

#include <cstddef>

namespace fleetloc {

// Counters order nothing else in memory.
constexpr auto kRelaxed = std::memory_order_relaxed;

void MalformedDatagrams::add(RtpsDefect defect) {
  counts_.at(static_cast<std::size_t>(defect)).fetch_add(1, kRelaxed);
}

std::map<std::string, std::uint64_t> MalformedDatagrams::counts() const {
  std::map<std::string, std::uint64_t> counts;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    const std::uint64_t count = counts_.at(i).load(kRelaxed);
    if (count > 0) counts.emplace(name(static_cast<RtpsDefect>(i)), count);
  }
  return counts;
}

}  // namespace fleetloc
