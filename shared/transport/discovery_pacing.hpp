#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>

#include "shared/transport/delay_line.hpp"
#include "shared/transport/emulated_link.hpp"
#include "shared/transport/workarounds/discovery_queue.hpp"
#include "shared/transport/workarounds/peer_address_filter.hpp"

namespace fleetloc {

/// Keeps discovery from filling a narrow link: a DiscoveryQueue for all that a robot sends, or for
/// each address that a localizer sends to, since it is the robots who have the narrow links.
/// Any thread may use any function.
class DiscoveryPacing {
 public:
  using Locator = PeerAddressFilter::Locator;

  /// @param bytes_per_s  on the wire; 0: without a limit
  DiscoveryPacing(ChannelRole role, double bytes_per_s) : role_(role), bytes_per_s_(bytes_per_s) {}

  [[nodiscard]] bool is_limited() const { return bytes_per_s_ > 0.0; }
  /// What has to wait for its turn, and how it compares with others.
  /// @param to  any of its destinations
  [[nodiscard]] std::optional<RepeatedDatagram> limited(RtpsBytes datagram,
                                                        const Locator& to) const;

  /// Calls `send` when it is this datagram's turn, at once or on the thread of `line`; never if it
  /// has just been said, or if a newer one about the same comes before. Expects that `line` ends
  /// before this object.
  /// @param datagram  that is limited
  /// @param bytes     of it
  /// @param socket    only tells those of one socket from those of another
  void send_later(RepeatedDatagram datagram,
                  std::size_t bytes,
                  const void* socket,
                  const Locator& to,
                  const std::function<void()>& send,
                  DelayLine& line);

 private:
  std::shared_ptr<DiscoveryQueue> queue_to(const Locator& to);
  static void take(const std::shared_ptr<DiscoveryQueue>& from, DelayLine& line);

  const ChannelRole role_;
  const double bytes_per_s_;
  std::mutex mutex_;
  std::map<Locator, std::shared_ptr<DiscoveryQueue>> queues_;  // guarded by mutex_
};

}  // namespace fleetloc
