#pragma once

#include <csignal>
#include <filesystem>
#include <optional>
#include <string>

#include "test/system/child_program.hpp"

namespace fleetloc {

/// The discovery server of Debian's package, on 127.0.0.1.
class DiscoveryServer {
 public:
  DiscoveryServer() : program_(kProgram, {"-i", "0", "-l", "127.0.0.1", "-p", "11811"}) {}

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

  ChildProgram program_;
};

}  // namespace fleetloc
