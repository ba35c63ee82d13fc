#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace fleetloc {

/// Loads the profiles of one network for the whole process. A file that is missing, has an error or
/// a profile name that is taken is a TransportError. Participants of this process will talk over
/// the network as those of different ones do: otherwise Fast DDS would pass by their transports.
///
/// Beyond what Fast DDS knows:
/// - `<dds xmlns:fleetloc="fleetloc" fleetloc:based_on="lan.xml">`: the profiles of that file, in
///   the same folder, but for those that this file defines.
/// - The addresses of a participant's initial peers and discovery servers may be host names. They
///   are looked up when a participant is made, not when the file is loaded: a host that is not
///   there yet, or has moved, is no error.
void load_qos_profiles(const std::filesystem::path& file);

/// Where a participant looks for others, by name.
struct NamedPeer {
  std::string host;
  std::uint32_t port = 0;     ///< 0: those of the first participants of a computer
  std::string server_prefix;  ///< of the GUID of a discovery server; empty: not a server
  auto operator<=>(const NamedPeer&) const = default;  // NOLINT(modernize-use-nullptr)
};

/// Of a loaded participant profile.
std::vector<NamedPeer> named_peers(const std::string& participant_profile);

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

}  // namespace fleetloc
