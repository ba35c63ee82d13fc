#pragma once

#include <string>

namespace fleetloc {

/// What differs from the defaults of this build, as a table; empty if nothing does.
/// @param yaml  config.yaml of a run. Throws ConfigError if it is not YAML.
std::string configuration_differences(const std::string& yaml);

}  // namespace fleetloc
