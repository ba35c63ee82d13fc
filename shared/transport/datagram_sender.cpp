#include "shared/transport/datagram_sender.hpp"

#include <utility>
#include <vector>

#include <fastdds/rtps/network/SenderResource.h>
#include <fastrtps/utils/IPLocator.h>

namespace fleetloc {

namespace rtps = eprosima::fastrtps::rtps;

namespace {

bool transmit(rtps::SenderResource& socket,
              RtpsBytes datagram,
              const DatagramSender::Destinations& destinations,
              DatagramSender::Clock::time_point timeout) {
  rtps::Locators first(destinations.begin());
  rtps::Locators last(destinations.end());
  const auto size = static_cast<std::uint32_t>(datagram.size());
  return socket.send(datagram.data(), size, &first, &last, timeout);
}

DatagramSender::Destinations only(const rtps::Locator_t& to) {
  DatagramSender::Destinations destination;
  destination.push_back(to);
  return destination;
}

std::vector<std::uint8_t> copied(RtpsBytes datagram) {
  return {datagram.begin(), datagram.end()};
}

}  // namespace

bool DatagramSender::begins_with(Socket* socket) {
  Socket* none = nullptr;  // yet; they are called in their order
  return first_socket_ == none && first_socket_.compare_exchange_strong(none, socket);
}

bool DatagramSender::reaches(const Socket* socket, const Locator& to) const {
  return counts(socket) || rtps::IPLocator::isMulticast(to);
}

bool DatagramSender::send(Socket* socket,
                          RtpsBytes datagram,
                          const Destinations& destinations,
                          Clock::time_point timeout) {
  if (link_.start.is_closed()) {
    link_.start.hold([this, socket, copy = copied(datagram), destinations] {
      emulate(socket, copy, destinations, Clock::now() + kPatience);
    });
    return true;
  }
  return emulate(socket, datagram, destinations, timeout);
}

bool DatagramSender::emulate(Socket* socket,
                             RtpsBytes datagram,
                             const Destinations& destinations,
                             Clock::time_point timeout) {
  const auto bytes = static_cast<std::uint32_t>(datagram.size());
  if (counts(socket)) link_.traffic.sent(bytes, destinations.size());
  if (!link_.emulated) return transmit(*socket, datagram, destinations, timeout);
  for (const Locator& to : destinations) {
    if (!reaches(socket, to)) continue;
    for (const Clock::time_point due : link_.emulated->outgoing_at(bytes, Clock::now())) {
      delay_line_.at(due, [socket, to, copy = copied(datagram)] {
        transmit(*socket, copy, only(to), Clock::now() + kPatience);
      });
    }
  }
  return true;
}

std::function<void()> DatagramSender::sending(Socket* socket,
                                              RtpsBytes datagram,
                                              const Locator& to) {
  return [this, socket, to, copy = copied(datagram)] {
    send(socket, copy, only(to), Clock::now() + kPatience);
  };
}

void DatagramSender::send_copies(
    Socket* socket, RtpsBytes datagram, const Locator& to, int number, Clock::time_point now) {
  for (int i = 1; i <= number; ++i) {
    delay_line_.at(now + i * kBetweenCopies, sending(socket, datagram, to));
  }
}

std::function<void()> DatagramSender::twice(std::function<void()> send) {
  return [this, send = std::move(send)] {
    send();
    delay_line_.at(Clock::now() + kBetweenCopies, send);
  };
}

}  // namespace fleetloc
