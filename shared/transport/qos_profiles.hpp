#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "shared/transport/workarounds/peer_lookup.hpp"

namespace fleetloc {

/// Loads the profiles of one network for the whole process. A file that is missing, has an error or
/// a profile name that is taken is a TransportError. Turns off intraprocess delivery, which would
/// bypass the transports of participants in this process.
///
/// Beyond what Fast DDS knows:
/// - `<dds xmlns:fleetloc="fleetloc" fleetloc:based_on="lan.xml">`: the profiles of that file, in
///   the same folder, but for those that this file defines. It may have a base of its own.
/// - The addresses of a participant's initial peers and discovery servers may be host names. They
///   are resolved when a participant is created, not when the file is loaded: a host that is not
///   known yet, or has moved, is no error.
void load_qos_profiles(const std::filesystem::path& file);

/// The same with profiles that the program brings along.
/// @param over  those that are laid over them, if any
/// @param name  in messages
void load_embedded_qos_profiles(std::string_view xml,
                                const std::string& name,
                                std::string_view over = {});

/// Peers and discovery servers of a loaded participant profile.
std::vector<NamedPeer> named_peers(const std::string& participant_profile);

}  // namespace fleetloc
