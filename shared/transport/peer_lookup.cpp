#include "shared/transport/peer_lookup.hpp"

#include <chrono>
#include <thread>
#include <utility>

namespace fleetloc {

void PeerLookup::start() {
  if (peers_.empty() || found_.valid()) return;
  std::packaged_task<FoundPeers()> task([peers = peers_] { return look_up(peers); });
  found_ = task.get_future();
  std::thread(std::move(task)).detach();
}

std::optional<FoundPeers> PeerLookup::take() {
  const bool ready =
      found_.valid() && found_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  if (!ready) return std::nullopt;
  return found_.get();
}

}  // namespace fleetloc
