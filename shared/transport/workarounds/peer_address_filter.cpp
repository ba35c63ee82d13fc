#include "shared/transport/workarounds/peer_address_filter.hpp"

#include <algorithm>

namespace fleetloc {
namespace {

using std::chrono::seconds;

// A live participant is heard more often: each sends its status every 10 s.
constexpr seconds kPeerFresh{15};
// Silent for longer, a participant is taken to be gone; one that returns announces itself again.
constexpr seconds kGone{60};
constexpr std::size_t kMaxParticipants = 4096;

}  // namespace

void PeerAddressFilter::announced(const GuidPrefix& participant, const Locator& locator, Time now) {
  const std::lock_guard lock(mutex_);
  if (!participants_.contains(participant) && participants_.size() >= kMaxParticipants) {
    participants_.clear();
    announcers_.clear();
  }
  Participant& known = participants_[participant];
  known.addresses.insert(locator.address);
  known.announced_at = now;
  std::set<GuidPrefix>& announcers = announcers_[locator];
  std::erase_if(announcers,
                [&](const GuidPrefix& one) { return now - participants_.at(one).last() > kGone; });
  announcers.insert(participant);
}

bool PeerAddressFilter::is_of(const GuidPrefix& participant, const Locator& locator) const {
  const std::lock_guard lock(mutex_);
  const auto announcers = announcers_.find(locator);
  return announcers != announcers_.end() && announcers->second.contains(participant);
}

void PeerAddressFilter::heard(const GuidPrefix& participant, std::uint32_t address, Time now) {
  const std::lock_guard lock(mutex_);
  const auto known = participants_.find(participant);
  if (known == participants_.end()) return;
  known->second.source = address;
  known->second.heard_at = now;
}

PeerAddressFilter::Time PeerAddressFilter::Participant::last() const {
  return source ? std::max(heard_at, announced_at) : announced_at;
}

bool PeerAddressFilter::is_redundant(const Locator& locator,
                                     std::span<const Locator> destinations,
                                     Time now) const {
  if (destinations.size() < 2) return false;  // it is the only one
  const std::lock_guard lock(mutex_);
  const auto announcers = announcers_.find(locator);
  if (announcers == announcers_.end()) return false;
  bool is_heard_elsewhere = false;
  for (const GuidPrefix& prefix : announcers->second) {
    const Participant& participant = participants_.at(prefix);
    if (now - participant.last() > kGone) continue;
    if (!participant.source || now - participant.heard_at > kPeerFresh) return false;
    if (participant.source == locator.address) return false;
    if (!participant.addresses.contains(*participant.source)) return false;  // translated
    const Locator heard_at{.address = *participant.source, .port = locator.port};
    if (std::ranges::find(destinations, heard_at) == destinations.end()) return false;
    is_heard_elsewhere = true;
  }
  return is_heard_elsewhere;
}

}  // namespace fleetloc
