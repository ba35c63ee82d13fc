#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "deploy/process/child_process.hpp"

namespace fleetloc {

/// Exit code and output of a program.
struct Outcome {
  int exit_code = -1;  ///< -1: it did not exit but crashed
  std::string output;
  std::string errors;
};

/// A running program, ended at the latest with this object. Its output goes to files, so it never
/// waits for a reader.
class ChildProgram {
 public:
  ChildProgram(const std::string& program, const std::vector<std::string>& arguments);
  ~ChildProgram();
  ChildProgram(const ChildProgram&) = delete;
  ChildProgram& operator=(const ChildProgram&) = delete;

  void signal(int number) const;
  /// What it has said on its standard output so far.
  [[nodiscard]] std::string output() const;
  /// Waits for its end.
  Outcome wait();

 private:
  std::filesystem::path output_;
  std::filesystem::path errors_;
  ChildProcess process_;
};

/// Runs a program to its end.
Outcome run(const std::string& program, const std::vector<std::string>& arguments);

/// A new folder, removed with this object.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const {
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

std::string content_of(const std::filesystem::path& file);

}  // namespace fleetloc
