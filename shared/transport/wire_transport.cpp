#include "shared/transport/wire_transport.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>
#include <fastdds/rtps/transport/UDPTransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>

#include "shared/transport/announcer.hpp"
#include "shared/transport/delay_line.hpp"
#include "shared/transport/locators.hpp"
#include "shared/transport/own_datagrams.hpp"
#include "shared/transport/workarounds/datagram_check.hpp"
#include "shared/transport/workarounds/gap_budget.hpp"
#include "shared/transport/workarounds/handshake_message.hpp"
#include "shared/transport/workarounds/initial_ack_pacing.hpp"
#include "shared/transport/workarounds/route_cache.hpp"
#include "shared/transport/workarounds/statistics_removal.hpp"

namespace fleetloc {

namespace fdr = eprosima::fastdds::rtps;
namespace rtps = eprosima::fastrtps::rtps;

namespace {

using Clock = std::chrono::steady_clock;

/// Keeps the settings of the transport that it wraps.
class WireDescriptor final : public fdr::ChainingTransportDescriptor {
 public:
  WireDescriptor(std::shared_ptr<TransportDescriptor> udp,
                 const RtpsLimits& limits,
                 std::shared_ptr<WireLink> link)
      : ChainingTransportDescriptor(std::move(udp)), limits_(limits), link_(std::move(link)) {}

  [[nodiscard]] fdr::TransportInterface* create_transport() const override;

  [[nodiscard]] const RtpsLimits& limits() const { return limits_; }
  [[nodiscard]] const std::shared_ptr<WireLink>& link() const { return link_; }
  [[nodiscard]] bool has_whitelist() const {
    const auto& udp = dynamic_cast<const fdr::UDPTransportDescriptor&>(*low_level_descriptor);
    return !udp.interfaceWhiteList.empty();
  }

 private:
  RtpsLimits limits_;
  std::shared_ptr<WireLink> link_;
};

/// Calls what observes, selects or delays datagrams, in the order of shared/README.md, "How a
/// datagram passes". Fast DDS uses one from several threads: those of writers and of events send,
/// one a socket receives.
class WireTransport final : public fdr::ChainingTransport {
 public:
  explicit WireTransport(const WireDescriptor& descriptor)
      : ChainingTransport(descriptor),
        descriptor_(descriptor),
        link_(descriptor.link()),
        // A robot's narrow link bears no copies for somebody who may not hear it.
        strangers_(link_->role == ChannelRole::kCloud ? link_->max_copies : 1),
        sender_(*link_, delay_line_, descriptor.has_whitelist()),
        repeating_sender_(*link_, delay_line_, sender_, strangers_),
        announcer_(link_->addresses, delay_line_, sender_, repeating_sender_, strangers_) {}
  ~WireTransport() override { stop(); }
  WireTransport(const WireTransport&) = delete;
  WireTransport& operator=(const WireTransport&) = delete;

  // The last moment at which what is delayed may still be used: the participant deletes its
  // sockets and receivers after it. What is still on its way is lost.
  void shutdown() override {
    stop();
    low_level_transport_->shutdown();
  }

  fdr::TransportDescriptorInterface* get_configuration() override { return &descriptor_; }

  void select_locators(rtps::LocatorSelector& selector) const override;

  bool send(rtps::SenderResource* socket,
            const rtps::octet* buffer,
            std::uint32_t size,
            rtps::LocatorsIterator* begin,
            rtps::LocatorsIterator* end,
            const std::chrono::steady_clock::time_point& timeout) override;

  void receive(fdr::TransportReceiverInterface* receiver,
               const rtps::octet* buffer,
               std::uint32_t size,
               const rtps::Locator_t& local,
               const rtps::Locator_t& remote) override;

 private:
  void stop() { delay_line_.stop(); }

  /// The destinations that a datagram is sent to: the first two steps.
  fdr::LocatorList useful(RtpsBytes datagram,
                          rtps::LocatorsIterator& begin,
                          const rtps::LocatorsIterator& end,
                          Clock::time_point now);
  /// A discovery server is told only what it does not know, and a silent one seldom.
  bool is_useless(RtpsBytes datagram,
                  const PeerAddressFilter::Locator& to,
                  Clock::time_point now) const {
    return link_->answered_heartbeats.includes(datagram, to) ||
           !link_->silent_servers.passes(to, now);
  }
  /// What comes behind the emulated link; on the thread of the delay line if there is one.
  void deliver(fdr::TransportReceiverInterface& receiver,
               RtpsBytes datagram,
               const rtps::Locator_t& local,
               const rtps::Locator_t& remote);

  WireDescriptor descriptor_;
  std::shared_ptr<WireLink> link_;
  AnnouncementRepetition strangers_;
  DatagramSender sender_;
  RepeatingSender repeating_sender_;
  Announcer announcer_;
  RouteCache routes_;  // with each participant anew, so after each change of addresses
  OwnDatagrams own_;
  GapBudget gaps_;
  InitialAckPacing initial_acks_;
  DelayLine delay_line_;  // last, so that it ends before what it uses
};

// Fast DDS sends to every address of a participant. A datagram to an unreachable network never
// leaves this computer, nor one that would arrive twice.
fdr::LocatorList WireTransport::useful(RtpsBytes datagram,
                                       rtps::LocatorsIterator& begin,
                                       const rtps::LocatorsIterator& end,
                                       Clock::time_point now) {
  fdr::LocatorList useful;
  std::vector<rtps::Locator_t> routed;  // the iterators are valid in this call only
  std::vector<PeerAddressFilter::Locator> locators;
  for (; begin != end; ++begin) {
    if (!IsLocatorSupported(*begin)) continue;
    if (rtps::IPLocator::isMulticast(*begin)) {
      useful.push_back(*begin);
    } else if (routes_.has_route(locator_of(*begin).address, now) &&
               !is_useless(datagram, locator_of(*begin), now)) {
      routed.push_back(*begin);
      locators.push_back(locator_of(*begin));
    }
  }
  for (std::size_t i = 0; i < routed.size(); ++i) {
    if (!link_->addresses.is_redundant(locators[i], locators, now)) useful.push_back(routed[i]);
  }
  return useful;
}

// NOLINTNEXTLINE(readability-function-size): the parameters are those of the library's interface
bool WireTransport::send(rtps::SenderResource* socket,
                         const rtps::octet* buffer,
                         std::uint32_t size,
                         rtps::LocatorsIterator* begin,
                         rtps::LocatorsIterator* end,
                         const std::chrono::steady_clock::time_point& timeout) {
  const RtpsBytes datagram = without_statistics({buffer, size});
  const Clock::time_point now = Clock::now();
  if (sender_.begins_with(socket) && link_->role == ChannelRole::kRobot && link_->max_copies > 1) {
    announcer_.announce_to_all_from(now);
  }
  own_.sent(datagram);
  if (sender_.is_first(socket) && !initial_acks_.passes(datagram, now)) return true;
  if (is_handshake_for_another(datagram)) return true;
  const fdr::LocatorList destinations = useful(datagram, *begin, *end, now);
  announcer_.sent(socket, datagram, destinations);
  return repeating_sender_.send(socket, datagram, destinations, timeout);
}

// Called by Fast DDS with the addresses of each participant, again whenever they change.
void WireTransport::select_locators(rtps::LocatorSelector& selector) const {
  ChainingTransport::select_locators(selector);
  const Clock::time_point now = Clock::now();
  for (const rtps::LocatorSelectorEntry* entry : selector.transport_starts()) {
    GuidPrefix participant{};
    std::ranges::copy(entry->remote_guid.guidPrefix.value, participant.begin());
    for (const rtps::Locator_t& locator : entry->unicast) {
      if (!IsLocatorSupported(locator)) continue;
      link_->addresses.announced(participant, locator_of(locator), now);
    }
  }
}

void WireTransport::receive(fdr::TransportReceiverInterface* receiver,
                            const rtps::octet* buffer,
                            std::uint32_t size,
                            const rtps::Locator_t& local,
                            const rtps::Locator_t& remote) {
  const RtpsBytes datagram(buffer, size);
  const auto checked = check_rtps(datagram, descriptor_.limits());
  if (!checked) return link_->malformed.add(checked.error());
  if (!gaps_.passes(datagram, Clock::now())) {
    return link_->malformed.add(RtpsDefect::kTooManyGaps);
  }
  if (own_.includes(datagram) ||
      (link_->ignores_own_process && own_.are_of_same_process(datagram))) {
    return receiver->OnDataReceived(buffer, size, local, remote);
  }
  const auto sender = link_->senders.check(datagram, locator_of(remote).address, Clock::now());
  if (!sender) return link_->malformed.add(sender.error());
  if (!link_->emulated) return deliver(*receiver, datagram, local, remote);
  for (const Clock::time_point due : link_->emulated->incoming_at(size, Clock::now())) {
    delay_line_.at(
        due, [this, receiver, local, remote, copy = std::vector(datagram.begin(), datagram.end())] {
          deliver(*receiver, copy, local, remote);
        });
  }
}

void WireTransport::deliver(fdr::TransportReceiverInterface& receiver,
                            RtpsBytes datagram,
                            const rtps::Locator_t& local,
                            const rtps::Locator_t& remote) {
  const Clock::time_point now = Clock::now();
  const auto size = static_cast<std::uint32_t>(datagram.size());
  link_->versions.observe(datagram);
  const auto recounted = link_->servers.observe(datagram, now);
  link_->silent_servers.heard(sender_of(datagram), now);
  link_->answered_heartbeats.observe(datagram);
  link_->addresses.heard(sender_of(datagram), locator_of(remote).address, now);
  link_->traffic.received(size);
  if (link_->role == ChannelRole::kRobot && announces_robot(datagram)) return;
  if (const auto own = own_.prefix()) announcer_.heard(datagram, *own, now);
  receiver.OnDataReceived(recounted ? recounted->data() : datagram.data(), size, local, remote);
}

fdr::TransportInterface* WireDescriptor::create_transport() const {
  return new WireTransport(*this);
}

}  // namespace

std::shared_ptr<TransportDescriptor> wire_transport(const std::shared_ptr<TransportDescriptor>& udp,
                                                    const RtpsLimits& limits,
                                                    std::shared_ptr<WireLink> link) {
  if (!std::dynamic_pointer_cast<fdr::UDPTransportDescriptor>(udp)) return nullptr;
  return std::make_shared<WireDescriptor>(udp, limits, std::move(link));
}

}  // namespace fleetloc
