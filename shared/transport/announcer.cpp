#include "shared/transport/announcer.hpp"

#include "shared/transport/locators.hpp"

namespace fleetloc {

void Announcer::heard(RtpsBytes datagram, const GuidPrefix& own, Clock::time_point now) {
  if (const auto pause = strangers_.heard(datagram, own, now)) {
    announce_again(sender_of(datagram), now + *pause);
  }
}

// Where its address is known, there in as many copies as are due; to everybody once otherwise.
void Announcer::announce_again(const GuidPrefix& to, Clock::time_point due) {
  delay_line_.at(due, [this, to, due] {
    const auto again = strangers_.again(to);
    if (!again) return;
    LatestAnnouncement::Sent announcement = latest_.latest();
    Destinations its_own;
    for (const auto& one : announcement.destinations) {
      if (addresses_.is_of(to, locator_of(one))) its_own.push_back(one);
    }
    if (!its_own.empty()) announcement.destinations = its_own;
    announce(announcement, its_own.empty() ? 1 : again->copies);
    announce_again(to, due + again->next);
  });
}

void Announcer::announce_to_all(Clock::time_point due) {
  delay_line_.at(due, [this, due] {
    const auto pause = strangers_.again_to_all();
    if (!pause) return;
    announce(latest_.latest(), 1);
    announce_to_all(due + *pause);
  });
}

void Announcer::announce(const LatestAnnouncement::Sent& announcement, int copies) {
  if (announcement.datagram.empty()) return;
  const Clock::time_point now = Clock::now();
  for (Socket* socket : announcement.sockets) {
    repeating_sender_.send(
        socket, announcement.datagram, announcement.destinations, now + DatagramSender::kPatience);
    for (const auto& to : announcement.destinations) {
      if (!sender_.reaches(socket, to)) continue;
      sender_.send_copies(socket, announcement.datagram, to, copies - 1, now);
    }
  }
}

}  // namespace fleetloc
