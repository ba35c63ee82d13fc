#include "shared/transport/workarounds/participant_recreation_policy.hpp"

#include <algorithm>

namespace fleetloc {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

// An interface that comes up changes several times: name, address, route.
constexpr milliseconds kSettling{100};
// Between attempts, while addresses come and go.
constexpr seconds kMinInterval{1};
constexpr int kMaxDoublings = 5;
// Any live participant is heard more often: each sends its status every 10 s.
constexpr seconds kSilence{15};
constexpr seconds kSilentLookupInterval{1};
constexpr seconds kLookupInterval{10};

std::string words(const InterfaceAddresses& addresses) {
  std::string text;
  for (const InterfaceAddress& one : addresses) text += (text.empty() ? "" : ", ") + one.address;
  return text;
}

std::string words(const ResolvedPeers& peers) {
  std::string text;
  for (const auto& [peer, address] : peers) {
    text += (text.empty() ? "" : ", ") + peer.host + " at " + address;
  }
  return text;
}

ParticipantRecreationPolicy::Clock::duration doubled(
    ParticipantRecreationPolicy::Clock::duration once, int times) {
  return once * (1 << std::clamp(times, 0, kMaxDoublings));
}

}  // namespace

void ParticipantRecreationPolicy::made(const Basis& basis, Time now) {
  basis_ = basis;
  addresses_ = basis.addresses;
  peers_ = basis.peers;
  if (!heard_at_) heard_at_ = now;
  is_after_change_ = changed_ || peers_changed_;
  if (is_after_change_) {
    patience_ = std::min(2 * timing_.announcements, timing_.lease);
  } else if (now - *heard_at_ > patience_) {
    patience_ =
        std::clamp(2 * patience_, longest_silence(), doubled(longest_silence(), kMaxDoublings));
  }
  changed_ = false;
  peers_changed_ = false;
  server_restarted_ = false;
  tried_at_ = now;
  failed_attempts_ = 0;
}

void ParticipantRecreationPolicy::failed(Time now) {
  tried_at_ = now;
  ++failed_attempts_;
}

void ParticipantRecreationPolicy::observe(const Observation& seen, Time now) {
  if (seen.addresses != addresses_) changed_at_ = now;
  addresses_ = seen.addresses;
  changed_ = changed_ || seen.addresses != basis_.addresses;
  is_expecting_ = seen.is_expecting;
  if (seen.heard == heard_) return;
  heard_ = seen.heard;
  heard_at_ = now;
  patience_ = longest_silence();
  is_after_change_ = false;
}

void ParticipantRecreationPolicy::lost(const InterfaceAddresses& addresses, Time now) {
  for (const InterfaceAddress& one : addresses) {
    if (!basis_.addresses.contains(one)) continue;
    changed_ = true;
    changed_at_ = now;
  }
}

// A peer that cannot be resolved now has not moved.
void ParticipantRecreationPolicy::found(const ResolvedPeers& peers, Time now) {
  if (std::ranges::includes(basis_.peers, peers)) return;
  peers_ = peers;
  peers_changed_ = true;
  changed_at_ = now;
}

bool ParticipantRecreationPolicy::wants_lookup(Time now) {
  const bool is_silent = heard_ == 0 || now - *heard_at_ > kSilence;
  const auto interval = is_silent ? kSilentLookupInterval : kLookupInterval;
  if (looked_up_at_ && now - *looked_up_at_ < interval) return false;
  looked_up_at_ = now;
  return true;
}

std::optional<std::string> ParticipantRecreationPolicy::due(Time now) const {
  const auto since_try = now - tried_at_;
  if (addresses_.empty() || since_try < doubled(kMinInterval, failed_attempts_ - 1))
    return std::nullopt;
  if (failed_attempts_ > 0) return "another try";
  if (changed_ && now - changed_at_ >= kSettling) {
    return "the network has changed, addresses are now " + words(addresses_);
  }
  if (peers_changed_) return "peers have moved, they are now " + words(peers_);
  if (server_restarted_) return "the discovery server was started again";
  const bool is_waiting = is_expecting_ || is_after_change_;
  if (heard_at_ && is_waiting && now - std::max(*heard_at_, tried_at_) > patience_) {
    return "nothing has been heard for " +
           std::to_string(std::chrono::duration_cast<seconds>(now - *heard_at_).count()) + " s";
  }
  return std::nullopt;
}

}  // namespace fleetloc
