#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace fleetloc {

/// Shows on a terminal how far a long piece of work has come: items, rate and time left. Writes to
/// stderr, at most ten times a second; nothing at all where stderr is no terminal. For programs
/// and the loops that they run.
class ProgressLine {
 public:
  /// @param work  e.g. "normals"
  explicit ProgressLine(std::string work);
  /// Leaves the line in place and ends it.
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void show(std::size_t done, std::size_t total);
  /// Clears the line for other output.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  std::string work_;
  bool terminal_;
  bool shown_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_{};
};

/// "normals  1234/5000  24 %  410/s  9 s left"
std::string progress_text(const std::string& work,
                          std::size_t done,
                          std::size_t total,
                          std::chrono::duration<double> elapsed);

}  // namespace fleetloc
