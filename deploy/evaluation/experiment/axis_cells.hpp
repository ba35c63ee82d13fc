#pragma once

#include <string>
#include <vector>

#include "deploy/evaluation/experiment/run.hpp"

namespace fleetloc {

using Cells = std::vector<std::string>;

inline const std::string kNoValue = "–";

/// First cells of a row about a run: its dataset, and the axes with more than one value in the
/// plan.
Cells axes_of(const Plan& plan, const Run& run);

/// Names of the columns of axes_of(), and others.
Cells header_of(const Plan& plan, const Cells& others);

}  // namespace fleetloc
