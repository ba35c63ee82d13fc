#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "shared/core/time.hpp"

namespace fleetloc {

/// A line of diagnostics.csv, without the covariances.
struct FrameLine {
  Timestamp stamp;
  std::string state;
  bool keyframe = false;
};

/// A line of answers.csv.
struct AnswerLine {
  Timestamp stamp;
  Timestamp arrival;
  std::string localizer;
  bool applied = false;
};

/// Lines of a run folder so far; the run may still be going on.
std::vector<FrameLine> frames_of(const std::filesystem::path& run);
std::vector<AnswerLine> answers_of(const std::filesystem::path& run);

/// Waits until the run has played `data` since its first frame.
/// @return the stamp that it has reached
/// Throws std::runtime_error after `patience` of real time.
Timestamp wait_for_data(const std::filesystem::path& run,
                        std::chrono::duration<double> data,
                        std::chrono::seconds patience = std::chrono::seconds(120));

}  // namespace fleetloc
