#include "shared/transport/repeating_sender.hpp"

#include "shared/link/datagrams.hpp"
#include "shared/transport/locators.hpp"

namespace fleetloc {
namespace {

constexpr std::size_t kShortHandshakeBytes = 2000;  // without certificate and permissions

}  // namespace

bool RepeatingSender::send(Socket* socket,
                           RtpsBytes datagram,
                           const Destinations& destinations,
                           Clock::time_point timeout) {
  if (destinations.empty()) return true;
  if (const auto limited = discovery_.limited(datagram, locator_of(*destinations.begin()))) {
    send_in_turn(socket, datagram, destinations, *limited);
    return true;
  }
  send_copies_of_what_is_repeated(socket, datagram, destinations, Clock::now());
  return sender_.send(socket, datagram, destinations, timeout);
}

void RepeatingSender::send_in_turn(Socket* socket,
                                   RtpsBytes datagram,
                                   const Destinations& destinations,
                                   const RepeatedDatagram& limited) {
  for (const auto& to : destinations) {
    if (!sender_.reaches(socket, to)) continue;
    auto send = sender_.sending(socket, datagram, to);
    // The last message of an authentication, which its sender repeats only if it hears the one
    // before again, and that is four times as long.
    if (limited.is_handshake && datagram.size() < kShortHandshakeBytes) send = sender_.twice(send);
    discovery_.send_later(limited, datagram.size(), socket, locator_of(to), send, delay_line_);
  }
}

void RepeatingSender::send_copies_of_what_is_repeated(Socket* socket,
                                                      RtpsBytes datagram,
                                                      const Destinations& destinations,
                                                      Clock::time_point now) {
  if (max_copies_ <= 1) return;
  if (!strangers_.is_known()) return;           // nobody would understand it
  if (participant_sample_in(datagram)) return;  // as often as the profile says
  const auto repeated = RepeatedDatagram::read(datagram);
  if (!repeated || repeated->is_handshake) return;  // copies of those were no gain
  for (const auto& to : destinations) {
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

}  // namespace fleetloc
