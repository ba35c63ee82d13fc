#pragma once

// Makes up for: Fast DDS 2.9.1 resolves host names of peers and servers only while it loads a
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

/// Where a participant looks for others, by name.
struct NamedPeer {
  std::string host;
  std::uint32_t port = 0;     ///< 0: those of the first participants of a computer
  std::string server_prefix;  ///< of the GUID of a discovery server; empty: not a server
  auto operator<=>(const NamedPeer&) const = default;  // NOLINT(modernize-use-nullptr)
};

/// A peer at one of the addresses of its host.
struct FoundPeer {
  NamedPeer peer;
  std::string address;
  auto operator<=>(const FoundPeer&) const = default;  // NOLINT(modernize-use-nullptr)
};
using FoundPeers = std::set<FoundPeer>;

/// At all IPv4 addresses of its host; none if that is not known. Waits for the name servers, which
/// can take many seconds.
FoundPeers look_up(const NamedPeer& peer);

/// Looks peers up, all at once: where names are not known, or name servers cannot be reached, that
/// takes many seconds. A lookup that is under way when this object ends goes on behind it, since
/// the system cannot be told to stop.
class PeerLookup {
 public:
  explicit PeerLookup(const std::vector<NamedPeer>& peers);

  /// Begins to look for those that are not being looked for.
  void start();
  /// All that has been found so far, if a lookup has ended since the last call. A peer that is not
  /// found any more is where it was.
  std::optional<FoundPeers> take();
  /// What is found in that time.
  FoundPeers find(std::chrono::milliseconds patience);

 private:
  struct Search {
    NamedPeer peer;
    std::future<FoundPeers> under_way;
    FoundPeers found;
  };
  [[nodiscard]] FoundPeers found() const;

  std::vector<Search> searches_;
};

}  // namespace fleetloc
