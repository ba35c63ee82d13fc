#pragma once

#include <filesystem>
#include <map>

#include "cloud/pool/session_report.hpp"
#include "shared/core/ids.hpp"

namespace fleetloc {

/// Writes sessions.json. Throws std::runtime_error that names the file.
void write_sessions(const std::filesystem::path& file,
                    const std::map<RobotId, SessionReport>& reports);

}  // namespace fleetloc
