#pragma once

#include <filesystem>
#include <stop_token>

#include "deploy/evaluation/experiment/plan.hpp"
#include "deploy/evaluation/experiment/programs.hpp"

namespace fleetloc {

struct ExperimentOptions {
  std::filesystem::path plan_file;
  std::filesystem::path out;
  std::filesystem::path store;  ///< of datasets and maps that are made
  int jobs = 1;
};

/// Counts of runs.
struct ExperimentCounts {
  std::size_t runs = 0;      ///< of the plan
  std::size_t finished = 0;  ///< well
  std::size_t failed = 0;
};

/// Makes what is missing of datasets, maps and runs, and then results.csv and report.html of all
/// results, also if a stop was requested. Prints a line for each piece of work. Throws
/// std::runtime_error, e.g. if a dataset cannot be made.
ExperimentCounts run_experiment(const Plan& plan,
                                const Programs& programs,
                                const ExperimentOptions& options,
                                const std::stop_token& stop);

}  // namespace fleetloc
