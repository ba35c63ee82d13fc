#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>

#include <fastdds/rtps/transport/TransportDescriptorInterface.h>

#include "shared/link/link_model.hpp"
#include "shared/transport/workarounds/peer_address_filter.hpp"
#include "shared/transport/workarounds/rtps_message.hpp"
#include "shared/transport/workarounds/server_restart_detector.hpp"

namespace fleetloc {

/// Which end of its link a participant is.
enum class ChannelRole { kRobot, kCloud };

/// Traffic at the IP level, with all headers, and with the meta traffic of DDS.
struct WireTraffic {
  std::uint64_t sent_bytes = 0;      ///< before the emulated link
  std::uint64_t received_bytes = 0;  ///< behind it
  std::uint64_t sent_datagrams = 0;
  std::uint64_t received_datagrams = 0;
  std::uint64_t malformed_datagrams = 0;  ///< not RTPS: dropped, and in none of the above
};

/// Counts the traffic of a participant and its successors, and emulates a link around them. Any
/// thread may use any function.
///
/// The link is that of a robot, at whichever end it is emulated: a robot's participant puts what it
/// sends on the uplink and what it receives on the downlink, a localizer's the other way round, for
/// all its robots together. Where both ends emulate a link, both count.
class WireLink {
 public:
  using Clock = std::chrono::steady_clock;

  WireLink(ChannelRole role, const std::optional<LinkConfig>& link);

  /// To be called before each participant is made.
  /// @param servers  discovery servers of which it will be a client
  void begin_participant(const std::set<GuidPrefix>& servers);

  [[nodiscard]] bool is_emulated() const { return outgoing_.has_value(); }

  /// Time at which a datagram leaves or reaches this computer; nothing if it is lost.
  std::optional<Clock::time_point> outgoing_at(std::uint32_t datagram_bytes);
  std::optional<Clock::time_point> incoming_at(std::uint32_t datagram_bytes);

  void count_sent(const std::uint8_t* datagram, std::uint32_t bytes);
  /// @param address  that it came from, IPv4
  void count_received(const std::uint8_t* datagram, std::uint32_t bytes, std::uint32_t address);
  void count_malformed();
  /// True for a multicast that comes back to its sender; it never left the computer.
  [[nodiscard]] bool is_own(const std::uint8_t* datagram, std::uint32_t bytes) const;

  /// See PeerAddressFilter.
  void note_announced(const GuidPrefix& participant, const PeerAddressFilter::Locator& locator);
  [[nodiscard]] bool is_redundant(const PeerAddressFilter::Locator& locator,
                                  std::span<const PeerAddressFilter::Locator> destinations) const;

  [[nodiscard]] WireTraffic traffic() const;
  /// A discovery server was restarted since begin_participant().
  [[nodiscard]] bool has_server_restarted() const;

 private:
  mutable std::mutex mutex_;
  std::optional<LinkModel> outgoing_, incoming_;  // guarded by mutex_, but not whether they exist
  std::optional<GuidPrefix> own_prefix_;          // guarded by mutex_
  WireTraffic traffic_;                           // guarded by mutex_
  ServerRestartDetector servers_;                 // guarded by mutex_
  PeerAddressFilter addresses_;                   // guarded by mutex_
};

using TransportDescriptor = eprosima::fastdds::rtps::TransportDescriptorInterface;

/// A transport around `udp`, which must be a UDP transport, that counts what passes and emulates
/// the link. Nothing if it is not UDP.
std::shared_ptr<TransportDescriptor> wire_transport(const std::shared_ptr<TransportDescriptor>& udp,
                                                    std::shared_ptr<WireLink> link);

}  // namespace fleetloc
