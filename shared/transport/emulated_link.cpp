#include "shared/transport/emulated_link.hpp"

#include "shared/link/datagrams.hpp"

namespace fleetloc {

namespace {

Timestamp to_timestamp(EmulatedLink::Time time) {
  return Timestamp(std::chrono::duration_cast<Duration>(time.time_since_epoch()));
}

EmulatedLink::Time to_time(Timestamp stamp) {
  using SteadyDuration = EmulatedLink::Time::duration;
  return EmulatedLink::Time(std::chrono::duration_cast<SteadyDuration>(stamp.time_since_epoch()));
}

}  // namespace

EmulatedLink::EmulatedLink(ChannelRole role, const LinkConfig& link)
    : outgoing_(role == ChannelRole::kRobot ? link.uplink : link.downlink, link.seed),
      incoming_(role == ChannelRole::kRobot ? link.downlink : link.uplink, link.seed + 1) {}

std::optional<EmulatedLink::Time> EmulatedLink::Direction::arrival(std::uint32_t bytes, Time now) {
  const std::lock_guard lock(mutex_);
  const auto arrival = model_.arrival(to_timestamp(now), bytes + kIpUdpBytes);
  return arrival ? std::optional(to_time(*arrival)) : std::nullopt;
}

}  // namespace fleetloc
