#pragma once

#include <csignal>
#include <filesystem>
#include <optional>
#include <string>

#include "test/system/child_program.hpp"

namespace fleetloc {

/// A discovery server of Debian's package, on 127.0.0.1.
class DiscoveryServer {
 public:
  DiscoveryServer() : DiscoveryServer(0, {}) {}
  /// @param number  0 or 1: its id, and its port above 11811
  /// @param backup  folder that it keeps what it knows in; empty: nowhere
  DiscoveryServer(int number, const std::filesystem::path& backup)
      : program_("/bin/sh", {"-c", command(number, backup)}) {}

  /// Why it cannot be started, if so.
  static std::optional<std::string> why_impossible() {
    if (std::filesystem::exists(kProgram)) return std::nullopt;
    return std::string("there is no ") + kProgram;
  }

  void kill() {
    program_.signal(SIGKILL);
    program_.wait();
  }

 private:
  static constexpr const char* kProgram = "/usr/bin/fast-discovery-server";

  static std::string command(int number, const std::filesystem::path& backup) {
    const std::string program = std::string("exec ") + kProgram + " -i " + std::to_string(number) +
                                " -l 127.0.0.1 -p " + std::to_string(11811 + number);
    return backup.empty() ? program : "cd " + backup.string() + " && " + program + " -b";
  }

  ChildProgram program_;
};

}  // namespace fleetloc
