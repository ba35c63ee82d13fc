#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "deploy/evaluation/errors/eval_run.hpp"
#include "deploy/evaluation/report/report.hpp"

namespace fleetloc {

/// Command line arguments for run folders.
struct RunArguments {
  std::vector<std::string> runs;
  std::vector<std::string> truths;  ///< one for all runs, one for each, or none
  std::string report;               ///< HTML file; empty: no report
  std::string map;
  std::vector<std::string> sessions;
};

/// Throws std::invalid_argument for arguments that do not fit together, and for what is not there.
void check(const RunArguments& arguments);

/// The ground truth of all runs, read.
std::vector<ReportRun> opened_runs(const RunArguments& arguments);

/// Computes evaluation.json of every run that has ground truth, and writes it; of the others takes
/// the one that is there. Throws std::runtime_error.
void evaluate_all(std::vector<ReportRun>& runs, const EvaluationConfig& config);

/// Writes the report. Throws std::runtime_error that names what is missing.
/// @return  its size in bytes
std::size_t write_report(const RunArguments& arguments,
                         const std::vector<ReportRun>& runs,
                         const EvaluationConfig& config);

}  // namespace fleetloc
