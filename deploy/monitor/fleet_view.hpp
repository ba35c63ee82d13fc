#pragma once

#include <string>
#include <vector>

#include "deploy/monitor/watched_run.hpp"

namespace fleetloc {

/// State of the fleet at one moment.
struct FleetView {
  std::vector<RobotView> robots;
  std::vector<LocalizerView> localizers;
};

/// A line for each robot and each localizer, under headings; each with a newline.
std::string table(const FleetView& fleet);

/// The same in one line, without newline.
std::string line(const FleetView& fleet);

}  // namespace fleetloc
