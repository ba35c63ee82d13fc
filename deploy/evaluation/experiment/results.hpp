#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "deploy/evaluation/experiment/run.hpp"

namespace fleetloc {

/// A run that has ended, with its output.
struct Result {
  const Run* run;
  std::filesystem::path folder;
  int exit_status = 0;
  std::string failure;     ///< empty: it ended well
  nlohmann::json summary;  ///< of a run that ended well, as the next two
  nlohmann::json evaluation;
  nlohmann::json session;  ///< of its robot, in sessions.json; null for odometry alone
};

/// The runs that have ended, in the order of the plan. Throws std::runtime_error for a folder that
/// cannot be read.
std::vector<Result> read_results(const std::vector<Run>& runs, const std::filesystem::path& folder);

/// A number by its JSON pointer; null if it is not there.
nlohmann::json number_at(const nlohmann::json& object, const std::string& pointer);

/// results.csv: one line a run, the axes of the matrix and then the values, SI units. A value that
/// a run does not have is empty.
std::string results_csv(const std::vector<Result>& results);

}  // namespace fleetloc
