#include "deploy/monitor/recorded_fleet.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "shared/trajectory/tum_file.hpp"

namespace fleetloc {

RecordedFleet::RecordedFleet(const std::vector<std::string>& runs,
                             const std::vector<std::string>& truths,
                             const std::vector<std::string>& localizers) {
  if (truths.size() > 1 && truths.size() != runs.size()) {
    throw std::invalid_argument("--ground-truth: " + std::to_string(truths.size()) + " files for " +
                                std::to_string(runs.size()) +
                                " runs; give one for all of them, or one for each");
  }
  for (std::size_t i = 0; i < runs.size(); ++i) {
    Trajectory truth;
    if (!truths.empty()) truth = read_trajectory(truths[truths.size() == 1 ? 0 : i]);
    runs_.emplace_back(runs[i], std::move(truth));
  }
  for (const std::string& folder : localizers) localizers_.emplace_back(folder);
}

FleetView RecordedFleet::update(ArrivalTime /*now*/) {
  FleetView view;
  for (WatchedRun& run : runs_) view.robots.push_back(run.update());
  for (WatchedLocalizer& one : localizers_) view.localizers.push_back(one.update());
  return view;
}

bool RecordedFleet::has_ended(const FleetView& view) const {
  return std::ranges::all_of(view.robots, &RobotView::ended);
}

}  // namespace fleetloc
