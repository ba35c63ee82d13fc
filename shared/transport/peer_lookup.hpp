#pragma once

#include <future>
#include <optional>
#include <vector>

#include "shared/transport/qos_profiles.hpp"

namespace fleetloc {

/// Looks peers up without keeping anyone waiting. A lookup that is under way when this object ends
/// goes on behind it: the system cannot be told to stop.
class PeerLookup {
 public:
  explicit PeerLookup(std::vector<NamedPeer> peers) : peers_(std::move(peers)) {}

  /// Unless there is nothing to look up, or a lookup is under way.
  void start();
  /// What the last one has found, once.
  std::optional<FoundPeers> take();

 private:
  std::vector<NamedPeer> peers_;
  std::future<FoundPeers> found_;
};

}  // namespace fleetloc
