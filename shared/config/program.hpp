#pragma once

#include <cstdio>
#include <exception>
#include <functional>
#include <string>
#include <string_view>

#include <CLI/CLI.hpp>

#include "shared/config/config_reader.hpp"

namespace fleetloc {

/// What main() returns.
enum ExitCode : int { kSuccess = 0, kFailedAtRunTime = 1, kCannotStart = 2 };

/// For main(), so that nothing escapes it: what `body` returns, or 2 with its error on stderr.
template <typename Body>
int guarded(const Body& body) noexcept {
  try {
    return body();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
  } catch (...) {
    std::fputs("unknown error\n", stderr);
  }
  return kCannotStart;
}

/// What all programs have in common: --help, --version, --config FILE and --print-config; unknown
/// options are errors, and whatever goes wrong is one line on stderr and an exit code.
///
///     int main(int argc, char** argv) {
///       Program program("fleetloc-cloud", "Localizes robots in a laser map.", kDefaultConfig);
///       std::string map_file;
///       program.options().add_option("--map", map_file, "laser map")->required();
///       return program.run(argc, argv, [&] {
///         auto node = std::make_shared<Node>(load_map(map_file), program.config());
///         return [node] { return node->run(); };
///       });
///     }
class Program {
 public:
  using Run = std::function<int()>;

  /// @param default_config  YAML with all keys, embedded when the program is built
  Program(std::string name, const std::string& description, std::string_view default_config);
  ~Program() = default;
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  /// To add options and subcommands to, before run().
  CLI::App& options() { return app_; }

  /// The defaults, overlaid by the file of --config. Throws ConfigError.
  [[nodiscard]] ConfigReader config() const;

  /// The command line as a YAML comment, for files that record how a result was made.
  [[nodiscard]] const std::string& command_line() const { return command_line_; }

  /// Reads the command line, then prepares, then runs what `prepare` returned.
  /// @return for main(): 2 if the command line is wrong or `prepare` throws, 1 if the run throws,
  ///         else what the run returns
  int run(int argc, const char* const* argv, const std::function<Run()>& prepare);

 private:
  [[nodiscard]] std::string config_text() const;

  std::string name_;
  std::string_view default_config_;
  std::string config_file_;
  std::string command_line_;
  CLI::App app_;
};

}  // namespace fleetloc
