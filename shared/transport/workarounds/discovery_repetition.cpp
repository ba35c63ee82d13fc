#include "shared/transport/workarounds/discovery_repetition.hpp"

#include <algorithm>

namespace fleetloc {
namespace {

constexpr int kPatience = 20;                  // times
constexpr std::chrono::seconds kForgotten{4};  // four of the library's periods
constexpr std::size_t kManySaid = 2000;        // then those are dropped that are forgotten

}  // namespace

int DiscoveryRepetition::copies(const DiscoveryDatagram& datagram, Time now) {
  if (max_copies_ <= 1) return 1;
  const std::lock_guard lock(mutex_);
  if (said_.size() > kManySaid) {
    std::erase_if(said_, [&](const auto& one) { return now - one.second.last > kForgotten; });
  }
  Said& said = said_[datagram.statement];
  if (now - said.last > kForgotten) said.times = 0;
  said.last = now;
  ++said.times;
  return said.times > kPatience ? 1 : std::clamp(said.times - 1, 1, max_copies_);
}

}  // namespace fleetloc
