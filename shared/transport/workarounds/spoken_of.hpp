#pragma once

// Works around: Fast DDS 2.9.1 believes a participant what it tells of another one: that it leaves
// (CVE-2023-50257), where it is, which endpoints it has.
// Delete when: it does not, unless the participant is its discovery server.

#include <optional>
#include <set>
#include <vector>

#include "shared/transport/workarounds/peer_address_filter.hpp"
#include "shared/transport/workarounds/rtps_message.hpp"

namespace fleetloc {

/// What a sample of discovery says, as far as it concerns who may say it.
struct DiscoverySample {
  std::optional<GuidPrefix> of;       ///< the participant, or the one that the endpoint belongs to
  bool is_announcement = false;       ///< of a participant
  std::set<std::uint32_t> addresses;  ///< that it announces; IPv4, as in locator_of()
};

/// @param data  a DATA submessage
/// @return nothing if no built-in endpoint of discovery has written it
std::optional<DiscoverySample> discovery_sample(const RtpsSubmessage& data);

}  // namespace fleetloc
