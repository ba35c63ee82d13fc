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

void EmulatedLink::start(Time now) {
  std::call_once(started_, [&] {
    outgoing_.start(now);
    incoming_.start(now);
  });
}

void EmulatedLink::Direction::start(Time now) {
  const std::lock_guard lock(mutex_);
  model_.start(to_timestamp(now));
}

std::vector<EmulatedLink::Time> EmulatedLink::Direction::arrivals(std::uint32_t bytes, Time now) {
  std::vector<Time> times;
  const std::lock_guard lock(mutex_);
  for (const Timestamp arrival : model_.arrivals(to_timestamp(now), bytes + kIpUdpBytes)) {
    times.push_back(to_time(arrival));
  }
  return times;
}

}  // namespace fleetloc
