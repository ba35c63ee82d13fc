#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "shared/link/channel.hpp"
#include "shared/ros2/ros2_header.hpp"

namespace fleetloc {

/// diagnostic_msgs/DiagnosticStatus.
struct DiagnosticStatus {
  enum class Level : std::uint8_t { kOk = 0, kWarning = 1, kError = 2, kStale = 3 };

  Level level = Level::kOk;
  std::string component;
  std::string message;
  std::string hardware;
  std::vector<std::pair<std::string, std::string>> values;  ///< key, value
};

/// diagnostic_msgs/DiagnosticArray.
struct DiagnosticsMessage {
  Ros2Header header;
  std::vector<DiagnosticStatus> statuses;
};

Bytes encode(const DiagnosticsMessage& message);

}  // namespace fleetloc
