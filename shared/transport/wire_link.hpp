#pragma once

#include <optional>

#include "shared/transport/emulated_link.hpp"
#include "shared/transport/malformed_datagrams.hpp"
#include "shared/transport/traffic_counter.hpp"
#include "shared/transport/wire_version.hpp"
#include "shared/transport/workarounds/answered_heartbeats.hpp"
#include "shared/transport/workarounds/known_senders.hpp"
#include "shared/transport/workarounds/peer_address_filter.hpp"
#include "shared/transport/workarounds/server_restart_detector.hpp"
#include "shared/transport/workarounds/silent_server_pacing.hpp"
#include "shared/transport/workarounds/start_gate.hpp"

namespace fleetloc {

/// What is known of a channel's datagrams for longer than one of its participants lives. Each
/// member stands alone, and any thread may use it; shared/README.md has their order.
struct WireLink {
  WireLink(ChannelRole its_role, const std::optional<LinkConfig>& link) : role(its_role) {
    if (link) emulated.emplace(its_role, *link);
  }

  const ChannelRole role;
  /// Of discovery [bytes a second, on the wire]: all that a robot sends, and what a localizer sends
  /// to each address. 0: as much as there is.
  double max_discovery_bytes_per_s = 0.0;
  /// Of what discovery and reliable endpoints have to say again and again, see RepetitionCopies.
  int max_copies = 1;
  /// Participants of the same process are not discovered, so what they send here is no traffic.
  bool ignores_own_process = false;
  std::optional<EmulatedLink> emulated;
  KnownSenders senders;
  WireVersionWatch versions;
  ServerRestartDetector servers;
  SilentServerPacing silent_servers;
  AnsweredHeartbeats answered_heartbeats;
  PeerAddressFilter addresses;
  StartGate start;
  TrafficCounter traffic;
  MalformedDatagrams malformed;  ///< in none of the traffic's numbers
};

}  // namespace fleetloc
