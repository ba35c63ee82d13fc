#pragma once

#include <filesystem>
#include <map>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <vector>

namespace fleetloc {

/// Thrown where a stop was requested before a program had ended.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted") {}
};

/// A program that did not end well.
class ProgramFailed : public std::runtime_error {
 public:
  ProgramFailed(const std::string& message, int exit_code)
      : std::runtime_error(message), exit_code_(exit_code) {}
  [[nodiscard]] int exit_code() const { return exit_code_; }  ///< -1: a signal

 private:
  int exit_code_;
};

/// The programs of an experiment, by what they do: sim, map, replay, eval, cloud, robot.
class Programs {
 public:
  /// Throws std::runtime_error if one is not in the folder.
  explicit Programs(const std::filesystem::path& folder);

  [[nodiscard]] const std::string& path(const std::string& name) const;
  /// Hash of the program's content: a new version makes its results again.
  [[nodiscard]] const std::string& fingerprint(const std::string& name) const;

 private:
  std::map<std::string, std::string> paths_;
  std::map<std::string, std::string> fingerprints_;
};

/// Runs a program to its end, with everything that it prints in `log`. Throws Interrupted, after
/// having ended it, and ProgramFailed with the last line that it printed.
void run_program(const std::vector<std::string>& command,
                 const std::filesystem::path& log,
                 const std::stop_token& stop);

/// Throws ProgramFailed unless the exit code is one of success.
void expect_success(const std::string& program, int exit_code, const std::filesystem::path& log);

/// Content of a file; throws std::runtime_error.
std::string text_of(const std::filesystem::path& file);
void write_text(const std::filesystem::path& file, const std::string& text);

}  // namespace fleetloc
