#include "shared/transport/wire_transport.hpp"

#include <algorithm>
#include <atomic>
#include <utility>
#include <vector>

#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>
#include <fastdds/rtps/transport/UDPTransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>

#include "shared/transport/delay_line.hpp"
#include "shared/transport/workarounds/datagram_check.hpp"
#include "shared/transport/workarounds/network_addresses.hpp"

namespace fleetloc {

namespace fdr = eprosima::fastdds::rtps;
namespace rtps = eprosima::fastrtps::rtps;

namespace {

constexpr std::uint32_t kIpUdpBytes = 28;  // headers of IPv4 and UDP

Timestamp to_timestamp(WireLink::Clock::time_point time) {
  return Timestamp(std::chrono::duration_cast<Duration>(time.time_since_epoch()));
}

std::optional<WireLink::Clock::time_point> through(LinkModel& link, std::uint32_t datagram_bytes) {
  const auto arrival =
      link.arrival(to_timestamp(WireLink::Clock::now()), std::size_t{datagram_bytes} + kIpUdpBytes);
  if (!arrival) return std::nullopt;
  return WireLink::Clock::time_point(
      std::chrono::duration_cast<WireLink::Clock::duration>(arrival->time_since_epoch()));
}

std::uint32_t address_of(const rtps::Locator_t& locator) {
  const rtps::octet* bytes = rtps::IPLocator::getIPv4(locator);
  std::uint32_t address = 0;
  for (int i = 0; i < 4; ++i) address = address << 8U | bytes[i];
  return address;
}

PeerAddressFilter::Locator locator_of(const rtps::Locator_t& locator) {
  return {.address = address_of(locator), .port = locator.port};
}

bool transmit(rtps::SenderResource& socket,
              const rtps::octet* buffer,
              std::uint32_t size,
              const fdr::LocatorList& destinations,
              const WireLink::Clock::time_point& timeout) {
  rtps::Locators first(destinations.begin());
  rtps::Locators last(destinations.end());
  return socket.send(buffer, size, &first, &last, timeout);
}

/// Keeps the settings of the transport that it wraps.
class Descriptor final : public fdr::ChainingTransportDescriptor {
 public:
  Descriptor(std::shared_ptr<TransportDescriptor> udp, std::shared_ptr<WireLink> link)
      : ChainingTransportDescriptor(std::move(udp)), link_(std::move(link)) {}

  [[nodiscard]] fdr::TransportInterface* create_transport() const override;

  [[nodiscard]] const std::shared_ptr<WireLink>& link() const { return link_; }
  [[nodiscard]] bool has_whitelist() const {
    const auto& udp = dynamic_cast<const fdr::UDPTransportDescriptor&>(*low_level_descriptor);
    return !udp.interfaceWhiteList.empty();
  }

 private:
  std::shared_ptr<WireLink> link_;
};

class Transport final : public fdr::ChainingTransport {
 public:
  explicit Transport(const Descriptor& descriptor)
      : ChainingTransport(descriptor),
        descriptor_(descriptor),
        link_(descriptor.link()),
        delay_line_(link_->is_emulated() ? std::make_unique<DelayLine>() : nullptr) {}
  ~Transport() override { stop(); }
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;

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
  void stop() {
    if (delay_line_) delay_line_->stop();
  }

  // Fast DDS sends to every address of a participant. A datagram to an unreachable network never
  // leaves this computer, nor one that would arrive twice.
  [[nodiscard]] bool leaves(const rtps::Locator_t& to,
                            std::span<const PeerAddressFilter::Locator> destinations) const {
    if (rtps::IPLocator::isMulticast(to)) return true;
    return !link_->is_redundant(locator_of(to), destinations) &&
           has_route(rtps::IPLocator::toIPv4string(to));
  }

  // Fast DDS gives a datagram to all sockets of a UDP transport. Without a whitelist the first one
  // sends it to every address (a multicast on loopback only), the others, one an interface, send
  // multicasts only; with a whitelist every socket sends to every address.
  [[nodiscard]] bool sends(const rtps::SenderResource* socket, const rtps::Locator_t& to) const {
    return counts(socket) || rtps::IPLocator::isMulticast(to);
  }
  // A multicast counts once, not on every interface.
  [[nodiscard]] bool counts(const rtps::SenderResource* socket) const {
    return descriptor_.has_whitelist() || socket == first_socket_;
  }

  Descriptor descriptor_;
  std::shared_ptr<WireLink> link_;
  std::atomic<rtps::SenderResource*> first_socket_ = nullptr;
  std::unique_ptr<DelayLine> delay_line_;  // last, so that it ends before what it uses
};

// NOLINTNEXTLINE(readability-function-size): the parameters are those of the library's interface
bool Transport::send(rtps::SenderResource* socket,
                     const rtps::octet* buffer,
                     std::uint32_t size,
                     rtps::LocatorsIterator* begin,
                     rtps::LocatorsIterator* end,
                     const std::chrono::steady_clock::time_point& timeout) {
  rtps::SenderResource* none = nullptr;
  first_socket_.compare_exchange_strong(none, socket);  // they are called in their order
  std::vector<rtps::Locator_t> wanted;                  // the iterators are valid in this call only
  std::vector<PeerAddressFilter::Locator> locators;
  for (; *begin != *end; ++*begin) {
    if (!IsLocatorSupported(**begin)) continue;
    wanted.push_back(**begin);
    locators.push_back(locator_of(**begin));
  }
  fdr::LocatorList destinations;
  for (const rtps::Locator_t& to : wanted) {
    if (!leaves(to, locators)) continue;
    destinations.push_back(to);
    if (counts(socket)) link_->count_sent(buffer, size);
  }
  if (!delay_line_) return transmit(*socket, buffer, size, destinations, timeout);
  for (const rtps::Locator_t& to : destinations) {
    if (!sends(socket, to)) continue;
    const auto due = link_->outgoing_at(size);
    if (!due) continue;
    delay_line_->at(*due, [socket, to, copy = std::vector<rtps::octet>(buffer, buffer + size)] {
      fdr::LocatorList destination;
      destination.push_back(to);
      const auto soon = WireLink::Clock::now() + std::chrono::milliseconds(100);
      transmit(*socket, copy.data(), static_cast<std::uint32_t>(copy.size()), destination, soon);
    });
  }
  return true;
}

// Called by Fast DDS with the addresses of each participant, again whenever they change.
void Transport::select_locators(rtps::LocatorSelector& selector) const {
  ChainingTransport::select_locators(selector);
  for (const rtps::LocatorSelectorEntry* entry : selector.transport_starts()) {
    GuidPrefix participant{};
    std::ranges::copy(entry->remote_guid.guidPrefix.value, participant.begin());
    for (const rtps::Locator_t& locator : entry->unicast) {
      if (IsLocatorSupported(locator)) link_->note_announced(participant, locator_of(locator));
    }
  }
}

void Transport::receive(fdr::TransportReceiverInterface* receiver,
                        const rtps::octet* buffer,
                        std::uint32_t size,
                        const rtps::Locator_t& local,
                        const rtps::Locator_t& remote) {
  if (!is_well_formed_rtps({buffer, size})) return link_->count_malformed();
  if (link_->is_own(buffer, size)) {
    receiver->OnDataReceived(buffer, size, local, remote);
    return;
  }
  if (!delay_line_) {
    link_->count_received(buffer, size, address_of(remote));
    receiver->OnDataReceived(buffer, size, local, remote);
    return;
  }
  const auto due = link_->incoming_at(size);
  if (!due) return;
  const auto deliver = [this, receiver, local, remote](const std::vector<rtps::octet>& copy) {
    const auto bytes = static_cast<std::uint32_t>(copy.size());
    link_->count_received(copy.data(), bytes, address_of(remote));
    receiver->OnDataReceived(copy.data(), bytes, local, remote);
  };
  delay_line_->at(
      *due, [deliver, copy = std::vector<rtps::octet>(buffer, buffer + size)] { deliver(copy); });
}

fdr::TransportInterface* Descriptor::create_transport() const {
  return new Transport(*this);
}

}  // namespace

WireLink::WireLink(ChannelRole role, const std::optional<LinkConfig>& link) {
  if (!link) return;
  const bool is_robot = role == ChannelRole::kRobot;
  outgoing_.emplace(is_robot ? link->uplink : link->downlink, link->seed);
  incoming_.emplace(is_robot ? link->downlink : link->uplink, link->seed + 1);
}

void WireLink::begin_participant(const std::set<GuidPrefix>& servers) {
  const std::lock_guard lock(mutex_);
  own_prefix_.reset();
  servers_.watch(servers);
}

std::optional<WireLink::Clock::time_point> WireLink::outgoing_at(std::uint32_t datagram_bytes) {
  const std::lock_guard lock(mutex_);
  return through(*outgoing_, datagram_bytes);
}

std::optional<WireLink::Clock::time_point> WireLink::incoming_at(std::uint32_t datagram_bytes) {
  const std::lock_guard lock(mutex_);
  return through(*incoming_, datagram_bytes);
}

void WireLink::count_sent(const std::uint8_t* datagram, std::uint32_t bytes) {
  const std::lock_guard lock(mutex_);
  ++traffic_.sent_datagrams;
  traffic_.sent_bytes += bytes + kIpUdpBytes;
  if (own_prefix_ || bytes < kRtpsHeaderBytes) return;
  std::copy_n(datagram + kGuidPrefixAt, GuidPrefix().size(), own_prefix_.emplace().begin());
}

void WireLink::count_received(const std::uint8_t* datagram,
                              std::uint32_t bytes,
                              std::uint32_t address) {
  const std::lock_guard lock(mutex_);
  const Clock::time_point now = Clock::now();
  servers_.observe({datagram, bytes}, now);
  GuidPrefix sender{};
  std::copy_n(datagram + kGuidPrefixAt, sender.size(), sender.begin());
  addresses_.heard(sender, address, now);
  ++traffic_.received_datagrams;
  traffic_.received_bytes += bytes + kIpUdpBytes;
}

void WireLink::count_malformed() {
  const std::lock_guard lock(mutex_);
  ++traffic_.malformed_datagrams;
}

bool WireLink::is_own(const std::uint8_t* datagram, std::uint32_t bytes) const {
  const std::lock_guard lock(mutex_);
  return own_prefix_ && bytes >= kRtpsHeaderBytes &&
         std::equal(own_prefix_->begin(), own_prefix_->end(), datagram + kGuidPrefixAt);
}

void WireLink::note_announced(const GuidPrefix& participant,
                              const PeerAddressFilter::Locator& locator) {
  const std::lock_guard lock(mutex_);
  addresses_.announced(participant, locator, Clock::now());
}

bool WireLink::is_redundant(const PeerAddressFilter::Locator& locator,
                            std::span<const PeerAddressFilter::Locator> destinations) const {
  const std::lock_guard lock(mutex_);
  return addresses_.is_redundant(locator, destinations, Clock::now());
}

WireTraffic WireLink::traffic() const {
  const std::lock_guard lock(mutex_);
  return traffic_;
}

bool WireLink::has_server_restarted() const {
  const std::lock_guard lock(mutex_);
  return servers_.has_restarted();
}

std::shared_ptr<TransportDescriptor> wire_transport(const std::shared_ptr<TransportDescriptor>& udp,
                                                    std::shared_ptr<WireLink> link) {
  if (!std::dynamic_pointer_cast<fdr::UDPTransportDescriptor>(udp)) return nullptr;
  return std::make_shared<Descriptor>(udp, std::move(link));
}

}  // namespace fleetloc
