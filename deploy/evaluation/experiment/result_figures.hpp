#pragma once

#include <string>
#include <vector>

#include "deploy/evaluation/experiment/result_groups.hpp"

namespace fleetloc {

/// Box plots of the errors of position, as <figure> elements: over the links if there are several,
/// else over the configurations, else over the datasets; one for each combination of the others.
/// Throws std::runtime_error that names a file, or gnuplot.
std::string box_figures(const Plan& plan, const std::vector<Group>& groups, const Inputs& inputs);

}  // namespace fleetloc
