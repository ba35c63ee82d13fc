#include "shared/transport/workarounds/peer_address_filter.hpp"

#include <algorithm>

namespace fleetloc {
namespace {

using std::chrono::seconds;

// Who is there is heard more often: each second a localizer tells of itself.
constexpr seconds kFresh{5};
// Silent for longer, a participant is taken to be gone; one that comes back is announced again.
constexpr seconds kGone{60};
constexpr std::size_t kMaxParticipants = 4096;

}  // namespace

void PeerAddressFilter::announced(const GuidPrefix& participant, const Place& place, Time now) {
  if (!participants_.contains(participant) && participants_.size() >= kMaxParticipants) {
    participants_.clear();
    claims_.clear();
  }
  Participant& known = participants_[participant];
  known.addresses.insert(place.address);
  known.announced_at = now;
  std::set<GuidPrefix>& claims = claims_[place];
  std::erase_if(claims,
                [&](const GuidPrefix& one) { return now - participants_.at(one).last() > kGone; });
  claims.insert(participant);
}

void PeerAddressFilter::heard(const GuidPrefix& participant, std::uint32_t address, Time now) {
  const auto known = participants_.find(participant);
  if (known == participants_.end()) return;
  known->second.source = address;
  known->second.heard_at = now;
}

PeerAddressFilter::Time PeerAddressFilter::Participant::last() const {
  return source ? std::max(heard_at, announced_at) : announced_at;
}

bool PeerAddressFilter::is_superfluous(const Place& place,
                                       std::span<const Place> destinations,
                                       Time now) const {
  const auto claims = claims_.find(place);
  if (claims == claims_.end()) return false;
  bool is_heard_elsewhere = false;
  for (const GuidPrefix& prefix : claims->second) {
    const Participant& participant = participants_.at(prefix);
    if (now - participant.last() > kGone) continue;
    if (!participant.source || now - participant.heard_at > kFresh) return false;
    if (participant.source == place.address) return false;
    if (!participant.addresses.contains(*participant.source)) return false;  // translated
    const Place heard_at{.address = *participant.source, .port = place.port};
    if (std::ranges::find(destinations, heard_at) == destinations.end()) return false;
    is_heard_elsewhere = true;
  }
  return is_heard_elsewhere;
}

}  // namespace fleetloc
