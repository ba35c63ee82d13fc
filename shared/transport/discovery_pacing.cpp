#include "shared/transport/discovery_pacing.hpp"

#include <utility>

#include "shared/link/datagrams.hpp"

namespace fleetloc {
namespace {

constexpr std::size_t kManyQueues = 1000;  // then those are dropped in which nothing waits

/// Samples go to odd ports (DDS Interoperability Wire Protocol 2.2, chapter 9.6.1.1).
bool is_of_built_in_endpoints(const PeerAddressFilter::Locator& to) {
  return to.port % 2 == 0;
}

}  // namespace

std::optional<RepeatedDatagram> DiscoveryPacing::limited(RtpsBytes datagram,
                                                         const Locator& to) const {
  if (!is_limited()) return std::nullopt;
  auto repeated = RepeatedDatagram::read(datagram);
  if (!repeated && is_of_built_in_endpoints(to)) {
    repeated = RepeatedDatagram::read_encrypted(datagram);
  }
  return repeated && repeated->is_discovery ? repeated : std::nullopt;
}

void DiscoveryPacing::send_later(RepeatedDatagram datagram,
                                 std::size_t bytes,
                                 const void* socket,
                                 const Locator& to,
                                 const std::function<void()>& send,
                                 DelayLine& line) {
  datagram.address_to(socket, to);
  const auto queue = queue_to(to);
  const std::size_t wire_bytes = bytes + kIpUdpBytes;
  const auto now = DelayLine::Clock::now();
  if (queue->has_just_said(datagram, now)) return;
  if (queue->passes(datagram, wire_bytes, now)) return send();
  const auto due = queue->put(std::move(datagram), wire_bytes, send, now);
  if (due) line.at(*due, [queue, &line] { take(queue, line); });
}

std::shared_ptr<DiscoveryQueue> DiscoveryPacing::queue_to(const Locator& to) {
  const Locator key = role_ == ChannelRole::kRobot ? Locator{} : to;
  const std::lock_guard lock(mutex_);
  if (queues_.size() > kManyQueues) {
    std::erase_if(queues_, [](const auto& item) { return item.second.use_count() == 1; });
  }
  auto& queue = queues_[key];
  if (!queue) queue = std::make_shared<DiscoveryQueue>(bytes_per_s_);
  return queue;
}

void DiscoveryPacing::take(const std::shared_ptr<DiscoveryQueue>& from, DelayLine& line) {
  const auto [send, next] = from->take(DelayLine::Clock::now());
  if (send) send();
  if (next) line.at(*next, [from, &line] { take(from, line); });
}

}  // namespace fleetloc
