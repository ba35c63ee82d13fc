#pragma once

// Works around: Fast DDS 2.9.1 tells the cause of a failure (a wrong profile, a refused
// participant) only in its log, not in the return code.
// Delete when: its functions return or throw the reason.

#include <cstdint>
#include <deque>
#include <string>

namespace fleetloc {

/// Log of Fast DDS since the program started. Its lines are not printed.
struct LibraryLog {
  std::uint64_t warnings = 0;
  std::uint64_t errors = 0;
  std::string last_warning;
  std::deque<std::string> recent_errors;  ///< the latest 32, oldest first
};

/// The first call redirects the log; loading profiles and creating a participant do so.
LibraryLog library_log();

/// The first error after `before`: the cause of those that follow it. Empty if there was none.
std::string first_error_since(const LibraryLog& before);

}  // namespace fleetloc
