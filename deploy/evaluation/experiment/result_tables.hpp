#pragma once

#include <string>
#include <vector>

#include "deploy/evaluation/experiment/result_groups.hpp"

namespace fleetloc {

// Tables of report.html, one row a group. An axis with one value in the plan has no column, but the
// dataset always has.

/// Errors and controls.
std::string error_table(const Plan& plan, const std::vector<Group>& groups);
/// Network and computing.
std::string traffic_table(const Plan& plan, const std::vector<Group>& groups);
/// Empty if no run failed.
std::string failure_table(const std::vector<Result>& results);

}  // namespace fleetloc
