#pragma once

#include <string>
#include <vector>

#include "deploy/evaluation/experiment/results.hpp"

namespace fleetloc {

/// report.html: tables over the seeds, and a box plot for each axis that has several values.
/// @param plan_text  the plan as it was written
/// @param expected   runs of the plan
/// Throws std::runtime_error that names a file, or gnuplot.
std::string experiment_page(const Plan& plan,
                            const std::string& plan_text,
                            const std::vector<Result>& results,
                            const Inputs& inputs,
                            std::size_t expected);

/// Datasets in rows, for a terminal: median and standard deviation of the error, and the controls.
std::string error_lines(const std::vector<Result>& results);

}  // namespace fleetloc
