#pragma once

#include "shared/transport/datagram_sender.hpp"
#include "shared/transport/discovery_pacing.hpp"
#include "shared/transport/workarounds/announcement_repetition.hpp"
#include "shared/transport/workarounds/repetition_copies.hpp"

namespace fleetloc {

/// Sends each datagram as often as its destinations need: discovery waits for its turn where the
/// profile limits it; elsewhere, what the library has to repeat is sent in several copies.
/// From any thread, while the sockets live.
class RepeatingSender {
 public:
  using Clock = DatagramSender::Clock;
  using Socket = DatagramSender::Socket;
  using Destinations = DatagramSender::Destinations;

  /// All outlive it, but for `delay_line`, which ends before it.
  RepeatingSender(WireLink& link,
                  DelayLine& delay_line,
                  DatagramSender& sender,
                  const AnnouncementRepetition& strangers)
      : max_copies_(link.max_copies),
        delay_line_(delay_line),
        sender_(sender),
        strangers_(strangers),
        discovery_(link.role, link.max_discovery_bytes_per_s),
        repetition_(link.max_copies) {}

  /// False if the socket has refused it.
  bool send(Socket* socket,
            RtpsBytes datagram,
            const Destinations& destinations,
            Clock::time_point timeout);

 private:
  void send_in_turn(Socket* socket,
                    RtpsBytes datagram,
                    const Destinations& destinations,
                    const RepeatedDatagram& limited);
  void send_copies_of_what_is_repeated(Socket* socket,
                                       RtpsBytes datagram,
                                       const Destinations& destinations,
                                       Clock::time_point now);

  const int max_copies_;
  DelayLine& delay_line_;
  DatagramSender& sender_;
  const AnnouncementRepetition& strangers_;
  DiscoveryPacing discovery_;
  RepetitionCopies repetition_;
};

}  // namespace fleetloc
