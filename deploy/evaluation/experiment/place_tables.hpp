#pragma once

#include <string>
#include <vector>

#include "deploy/evaluation/experiment/result_groups.hpp"

namespace fleetloc {

// Tables of report.html about robots that look for their place, one row a group. Empty without
// such runs.

/// How many robots that nobody told their start were found, after how much way, and where wrong.
std::string place_table(const Plan& plan, const std::vector<Group>& groups);

/// The runs in which a robot took a wrong place for its own, one row each.
std::string wrong_place_table(const std::vector<Result>& results);

/// How soon robots that were carried away noticed, and were right again.
std::string carried_table(const Plan& plan, const std::vector<Group>& groups);

/// The first and the last of these tables as text; empty without such runs.
std::string place_lines(const std::vector<Result>& results);

}  // namespace fleetloc
