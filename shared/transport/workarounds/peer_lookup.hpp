#pragma once

// Works around: Fast DDS 2.9.1 resolves host names of peers and servers only while it loads a
// profile: a host that is not known yet is an error, and one that moves is never found.
// Delete when: names in profiles are resolved again while they are not reached.

#include <chrono>
#include <compare>
#include <cstdint>
#include <future>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace fleetloc {

/// A peer or discovery server of a profile, by name.
struct NamedPeer {
  std::string host;
  std::uint32_t port = 0;     ///< 0: those of the first participants of a computer
  std::string server_prefix;  ///< of the GUID of a discovery server; empty: not a server
  auto operator<=>(const NamedPeer&) const = default;  // NOLINT(modernize-use-nullptr)
};

/// A peer at one of the addresses of its host.
struct ResolvedPeer {
  NamedPeer peer;
  std::string address;
  auto operator<=>(const ResolvedPeer&) const = default;  // NOLINT(modernize-use-nullptr)
};
using ResolvedPeers = std::set<ResolvedPeer>;

/// All IPv4 addresses of its host; none if that cannot be resolved. Blocks, for up to many seconds.
ResolvedPeers look_up(const NamedPeer& peer);

/// Resolves peers concurrently: where names are not known, or name servers cannot be reached, that
/// takes many seconds. A lookup in progress outlives this object, since it cannot be cancelled.
class PeerLookup {
 public:
  explicit PeerLookup(const std::vector<NamedPeer>& peers);

  /// Starts a lookup of each peer that has none in progress.
  void start();
  /// All that has been found so far, if a lookup has ended since the last call. A peer that is no
  /// longer resolved keeps its last addresses.
  std::optional<ResolvedPeers> take();
  /// What is resolved within that time.
  ResolvedPeers find(std::chrono::milliseconds patience);

 private:
  struct Search {
    NamedPeer peer;
    std::future<ResolvedPeers> under_way;
    ResolvedPeers found;
  };
  [[nodiscard]] ResolvedPeers found() const;

  std::vector<Search> searches_;
};

}  // namespace fleetloc
