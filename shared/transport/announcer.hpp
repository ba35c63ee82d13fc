#pragma once

#include "shared/transport/latest_announcement.hpp"
#include "shared/transport/repeating_sender.hpp"

namespace fleetloc {

/// Announces this participant more often than the library does: to whoever has been heard and does
/// not know it, and, while nobody does, to whoever may be there. When, says AnnouncementRepetition.
/// From any thread, while the sockets live.
class Announcer {
 public:
  using Clock = DatagramSender::Clock;
  using Socket = DatagramSender::Socket;
  using Destinations = DatagramSender::Destinations;

  /// All outlive it, but for `delay_line`, which ends before it.
  Announcer(const PeerAddressFilter& addresses,
            DelayLine& delay_line,
            DatagramSender& sender,
            RepeatingSender& repeating_sender,
            AnnouncementRepetition& strangers)
      : addresses_(addresses),
        delay_line_(delay_line),
        sender_(sender),
        repeating_sender_(repeating_sender),
        strangers_(strangers) {}

  /// From a second after `now`, until somebody knows this participant.
  void announce_to_all_from(Clock::time_point now) {
    announce_to_all(now + AnnouncementRepetition::kFirstToAll);
  }

  /// @param datagram  any that the library sends; what it says last of this participant is repeated
  void sent(Socket* socket, RtpsBytes datagram, const Destinations& destinations) {
    latest_.sent(socket, datagram, destinations);
  }

  /// @param datagram  any that has arrived, well-formed RTPS
  /// @param own       of this participant
  void heard(RtpsBytes datagram, const GuidPrefix& own, Clock::time_point now);

 private:
  void announce_again(const GuidPrefix& to, Clock::time_point due);
  void announce_to_all(Clock::time_point due);
  void announce(const LatestAnnouncement::Sent& announcement, int copies);

  const PeerAddressFilter& addresses_;
  DelayLine& delay_line_;
  DatagramSender& sender_;
  RepeatingSender& repeating_sender_;
  AnnouncementRepetition& strangers_;
  LatestAnnouncement latest_;
};

}  // namespace fleetloc
