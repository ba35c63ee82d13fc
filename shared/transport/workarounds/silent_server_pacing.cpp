#include "shared/transport/workarounds/silent_server_pacing.hpp"

#include <algorithm>

namespace fleetloc {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Duration = std::chrono::steady_clock::duration;

// What has been heard for less than that is there, and answers.
constexpr seconds kFresh{10};
// A server announces itself every minute (qos_profiles/server.xml).
constexpr seconds kThere{100};
constexpr milliseconds kWindow{500};
constexpr milliseconds kFirstPause{500};
constexpr seconds kLongestAlone{8};
constexpr seconds kLongest{60};

}  // namespace

void SilentServerPacing::watch(const ServerLocators& servers) {
  const std::lock_guard lock(mutex_);
  servers_.clear();
  for (const auto& [prefix, locators] : servers) servers_[prefix].locators = locators;
  is_watching_ = !servers_.empty();
}

void SilentServerPacing::heard(const GuidPrefix& participant, Time now) {
  if (!is_watching_) return;
  const std::lock_guard lock(mutex_);
  const auto server = servers_.find(participant);
  if (server == servers_.end()) return;
  server->second.heard_at = now;
  server->second.open_until = {};
  server->second.opens_at = {};
  server->second.pause = {};
}

bool SilentServerPacing::is_another_there(const GuidPrefix& than, Time now) const {
  return std::ranges::any_of(servers_, [&](const auto& one) {
    const Time heard_at = one.second.heard_at;
    return one.first != than && heard_at != Time{} && now - heard_at < kThere;
  });
}

bool SilentServerPacing::passes(const Locator& destination, Time now) {
  if (!is_watching_) return true;
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find_if(
      servers_, [&](const auto& one) { return one.second.locators.contains(destination); });
  if (found == servers_.end()) return true;
  auto& [prefix, server] = *found;
  const bool is_fresh = server.heard_at != Time{} && now - server.heard_at < kFresh;
  if (is_fresh || now < server.open_until) return true;
  if (now < server.opens_at) return false;
  const Duration longest = is_another_there(prefix, now) ? kLongest : kLongestAlone;
  server.pause = std::clamp<Duration>(2 * server.pause, kFirstPause, longest);
  server.open_until = now + kWindow;
  server.opens_at = server.open_until + server.pause;
  return true;
}

}  // namespace fleetloc
