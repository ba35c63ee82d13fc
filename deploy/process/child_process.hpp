#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include <sys/types.h>

namespace fleetloc {

/// A command, and the files that its output goes to: the child never waits for a reader.
struct ChildCommand {
  std::vector<std::string> arguments;  ///< the program's path first
  std::filesystem::path output;        ///< is replaced
  std::filesystem::path errors;        ///< is replaced; may be the same file
};

/// How a program ended.
struct ExitStatus {
  int exit_code = -1;  ///< -1: a signal ended it
  int signal = 0;      ///< the signal
  double cpu_s = 0.0;  ///< user and system time
};

/// A running program with a process group of its own, so that signals of a terminal do not reach
/// it. It ends at the latest with this object, or with the thread that made it, however that one
/// ends.
class ChildProcess {
 public:
  /// Throws std::system_error if a file cannot be made or the program cannot be started.
  explicit ChildProcess(const ChildCommand& command);
  /// Kills what still runs.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Sends a signal to the program and its own children.
  void signal(int number) const;

  /// Waits for its end.
  ExitStatus wait();
  /// Waits for at most that long.
  std::optional<ExitStatus> wait_for(std::chrono::milliseconds limit);
  /// Waits for its end; nothing if a stop is requested first, and then it still runs.
  std::optional<ExitStatus> wait(const std::stop_token& stop);
  /// SIGTERM, and SIGKILL if it has not ended after `grace`.
  ExitStatus end(std::chrono::milliseconds grace);

 private:
  ExitStatus reap();

  pid_t pid_ = -1;
  int descriptor_ = -1;  ///< of the process; readable once it has ended
  std::optional<ExitStatus> end_;
};

}  // namespace fleetloc
