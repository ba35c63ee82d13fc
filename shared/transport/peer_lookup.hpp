#pragma once

#include <chrono>
#include <future>
#include <optional>
#include <vector>

#include "shared/transport/qos_profiles.hpp"

namespace fleetloc {

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
