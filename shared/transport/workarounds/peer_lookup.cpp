#include "shared/transport/workarounds/peer_lookup.hpp"

#include <array>
#include <thread>
#include <utility>

#include <arpa/inet.h>
#include <netdb.h>
#include <sys/socket.h>

namespace fleetloc {

ResolvedPeers look_up(const NamedPeer& peer) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* first = nullptr;
  if (getaddrinfo(peer.host.c_str(), nullptr, &hints, &first) != 0) return {};
  ResolvedPeers found;
  for (const addrinfo* it = first; it != nullptr; it = it->ai_next) {
    std::array<char, INET_ADDRSTRLEN> text{};
    const auto& address = reinterpret_cast<const sockaddr_in&>(*it->ai_addr);
    inet_ntop(AF_INET, &address.sin_addr, text.data(), static_cast<socklen_t>(text.size()));
    found.insert({.peer = peer, .address = text.data()});
  }
  freeaddrinfo(first);
  return found;
}

PeerLookup::PeerLookup(const std::vector<NamedPeer>& peers) {
  for (const NamedPeer& peer : peers) {
    searches_.push_back({.peer = peer, .under_way = {}, .found = {}});
  }
}

void PeerLookup::start() {
  for (Search& search : searches_) {
    if (search.under_way.valid()) continue;
    std::packaged_task<ResolvedPeers()> task([peer = search.peer] { return look_up(peer); });
    search.under_way = task.get_future();
    std::thread(std::move(task)).detach();
  }
}

std::optional<ResolvedPeers> PeerLookup::take() {
  bool ended = false;
  for (Search& search : searches_) {
    const bool ready =
        search.under_way.valid() &&
        search.under_way.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    if (!ready) continue;
    ended = true;
    ResolvedPeers found = search.under_way.get();
    if (!found.empty()) search.found = std::move(found);
  }
  return ended ? std::optional(found()) : std::nullopt;
}

ResolvedPeers PeerLookup::find(std::chrono::milliseconds patience) {
  start();
  const auto deadline = std::chrono::steady_clock::now() + patience;
  for (const Search& search : searches_) search.under_way.wait_until(deadline);
  static_cast<void>(take());
  return found();
}

ResolvedPeers PeerLookup::found() const {
  ResolvedPeers all;
  for (const Search& search : searches_) all.insert(search.found.begin(), search.found.end());
  return all;
}

}  // namespace fleetloc
