#pragma once

#include <filesystem>
#include <optional>

namespace fleetloc {

/// Loads what those need who watch the fleet, and the localizers that they watch, once for the
/// process: qos_profiles/monitor.xml as it was when the program was built, or a file that stands in
/// for it. Throws TransportError.
/// @param secure  without a file: those of monitor-secure.xml, for who has keys
void load_monitor_profiles(const std::optional<std::filesystem::path>& file = std::nullopt,
                           bool secure = false);

}  // namespace fleetloc
