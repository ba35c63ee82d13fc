#include "shared/transport/wire_transport.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>
#include <fastdds/rtps/transport/UDPTransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>

#include "shared/link/datagrams.hpp"
#include "shared/transport/datagram_sender.hpp"
#include "shared/transport/delay_line.hpp"
#include "shared/transport/discovery_pacing.hpp"
#include "shared/transport/latest_announcement.hpp"
#include "shared/transport/locators.hpp"
#include "shared/transport/own_datagrams.hpp"
#include "shared/transport/workarounds/announcement_repetition.hpp"
#include "shared/transport/workarounds/datagram_check.hpp"
#include "shared/transport/workarounds/gap_budget.hpp"
#include "shared/transport/workarounds/handshake_message.hpp"
#include "shared/transport/workarounds/initial_ack_pacing.hpp"
#include "shared/transport/workarounds/repetition_copies.hpp"
#include "shared/transport/workarounds/route_cache.hpp"
#include "shared/transport/workarounds/statistics_removal.hpp"

namespace fleetloc {

namespace fdr = eprosima::fastdds::rtps;
namespace rtps = eprosima::fastrtps::rtps;

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kShortHandshakeBytes = 2000;  // without certificate and permissions

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
        sender_(*link_, delay_line_, descriptor.has_whitelist()),
        discovery_(link_->role, link_->max_discovery_bytes_per_s),
        repetition_(link_->max_copies),
        // A robot's narrow link bears no copies for somebody who may not hear it.
        strangers_(link_->role == ChannelRole::kCloud ? link_->max_copies : 1) {}
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
  bool send_as_often_as_needed(rtps::SenderResource* socket,
                               RtpsBytes datagram,
                               const fdr::LocatorList& destinations,
                               Clock::time_point timeout);
  /// Whoever has been heard and does not know this participant.
  void announce_to_strangers(RtpsBytes datagram, Clock::time_point now);
  void announce_again(const GuidPrefix& to, Clock::time_point due);
  /// Whoever may be there, while nobody knows this participant.
  void announce_to_all(Clock::time_point due);
  /// In so many copies.
  void announce(const LatestAnnouncement::Sent& announcement, int copies);
  /// More of what the library repeats.
  void repeat_where_it_is_lost(rtps::SenderResource* socket,
                               RtpsBytes datagram,
                               const fdr::LocatorList& destinations,
                               Clock::time_point now);
  /// What comes behind the emulated link; on the thread of the delay line if there is one.
  void deliver(fdr::TransportReceiverInterface& receiver,
               RtpsBytes datagram,
               const rtps::Locator_t& local,
               const rtps::Locator_t& remote);

  WireDescriptor descriptor_;
  std::shared_ptr<WireLink> link_;
  DatagramSender sender_;
  RouteCache routes_;  // with each participant anew, so after each change of addresses
  OwnDatagrams own_;
  GapBudget gaps_;
  InitialAckPacing initial_acks_;
  DiscoveryPacing discovery_;
  RepetitionCopies repetition_;
  AnnouncementRepetition strangers_;
  LatestAnnouncement announcement_;
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
    announce_to_all(now + AnnouncementRepetition::kFirstToAll);
  }
  own_.sent(datagram);
  if (sender_.is_first(socket) && !initial_acks_.passes(datagram, now)) return true;
  if (is_handshake_for_another(datagram)) return true;
  const fdr::LocatorList destinations = useful(datagram, *begin, *end, now);
  announcement_.sent(socket, datagram, destinations);
  return send_as_often_as_needed(socket, datagram, destinations, timeout);
}

// Discovery is repeated where it is lost, and waits where the profile limits it.
bool WireTransport::send_as_often_as_needed(rtps::SenderResource* socket,
                                            RtpsBytes datagram,
                                            const fdr::LocatorList& destinations,
                                            Clock::time_point timeout) {
  if (destinations.empty()) return true;
  const auto limited = discovery_.limited(datagram, locator_of(*destinations.begin()));
  if (!limited) {
    repeat_where_it_is_lost(socket, datagram, destinations, Clock::now());
    return sender_.send(socket, datagram, destinations, timeout);
  }
  for (const rtps::Locator_t& to : destinations) {
    if (!sender_.reaches(socket, to)) continue;
    auto send = sender_.sending(socket, datagram, to);
    // The last message of an authentication, which its sender repeats only if it hears the one
    // before again, and that is four times as long.
    if (limited->is_handshake && datagram.size() < kShortHandshakeBytes) send = sender_.twice(send);
    discovery_.send_later(*limited, datagram.size(), socket, locator_of(to), send, delay_line_);
  }
  return true;
}

void WireTransport::repeat_where_it_is_lost(rtps::SenderResource* socket,
                                            RtpsBytes datagram,
                                            const fdr::LocatorList& destinations,
                                            Clock::time_point now) {
  if (link_->max_copies <= 1) return;
  if (!strangers_.is_known()) return;           // nobody would understand it
  if (participant_sample_in(datagram)) return;  // as often as the profile says
  const auto repeated = RepeatedDatagram::read(datagram);
  if (!repeated || repeated->is_handshake) return;  // copies of those were no gain
  for (const rtps::Locator_t& to : destinations) {
    if (!sender_.reaches(socket, to)) continue;
    RepeatedDatagram addressed = *repeated;
    addressed.address_to(socket, locator_of(to));
    sender_.send_copies(
        socket,
        datagram,
        to,
        repetition_.copies(addressed, locator_of(to), datagram.size() + kIpUdpBytes, now) - 1,
        now);
  }
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
  announce_to_strangers(datagram, now);
  receiver.OnDataReceived(recounted ? recounted->data() : datagram.data(), size, local, remote);
}

void WireTransport::announce_to_strangers(RtpsBytes datagram, Clock::time_point now) {
  const auto own = own_.prefix();
  if (!own) return;
  if (const auto pause = strangers_.heard(datagram, *own, now)) {
    announce_again(sender_of(datagram), now + *pause);
  }
}

void WireTransport::announce_again(const GuidPrefix& to, Clock::time_point due) {
  delay_line_.at(due, [this, to, due] {
    const auto again = strangers_.again(to);
    if (!again) return;
    LatestAnnouncement::Sent announcement = announcement_.latest();
    fdr::LocatorList its_own;
    for (const rtps::Locator_t& one : announcement.destinations) {
      if (link_->addresses.is_of(to, locator_of(one))) its_own.push_back(one);
    }
    if (!its_own.empty()) announcement.destinations = its_own;
    announce(announcement, its_own.empty() ? 1 : again->copies);
    announce_again(to, due + again->next);
  });
}

void WireTransport::announce_to_all(Clock::time_point due) {
  delay_line_.at(due, [this, due] {
    const auto pause = strangers_.again_to_all();
    if (!pause) return;
    announce(announcement_.latest(), 1);
    announce_to_all(due + *pause);
  });
}

void WireTransport::announce(const LatestAnnouncement::Sent& announcement, int copies) {
  if (announcement.datagram.empty()) return;
  const Clock::time_point now = Clock::now();
  for (rtps::SenderResource* socket : announcement.sockets) {
    send_as_often_as_needed(
        socket, announcement.datagram, announcement.destinations, now + DatagramSender::kPatience);
    for (const rtps::Locator_t& to : announcement.destinations) {
      if (!sender_.reaches(socket, to)) continue;
      sender_.send_copies(socket, announcement.datagram, to, copies - 1, now);
    }
  }
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
