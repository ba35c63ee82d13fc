#pragma once

#include <filesystem>
#include <optional>

namespace fleetloc {

/// Loads what a Ros2Participant needs, once for the process: qos_profiles/ros2.xml as it was when
/// the program was built, or a file that stands in for it. Throws TransportError.
void load_ros2_profiles(const std::optional<std::filesystem::path>& file = std::nullopt);

}  // namespace fleetloc
