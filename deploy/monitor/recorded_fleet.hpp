#pragma once

#include <string>
#include <vector>

#include "deploy/monitor/watched_fleet.hpp"
#include "deploy/monitor/watched_run.hpp"

namespace fleetloc {

/// Folders that robots and localizers write. Ends with all runs.
class RecordedFleet final : public WatchedFleet {
 public:
  /// Throws std::invalid_argument, and what reading a trajectory throws.
  /// @param runs  run folders; they may appear later
  /// @param truths  of the runs: none, one for all of them, or one for each
  /// @param localizers  folders of localizers
  RecordedFleet(const std::vector<std::string>& runs,
                const std::vector<std::string>& truths,
                const std::vector<std::string>& localizers);

  FleetView update(ArrivalTime now) override;
  [[nodiscard]] std::chrono::milliseconds settles_in() const override { return {}; }
  [[nodiscard]] bool has_ended(const FleetView& view) const override;

 private:
  std::vector<WatchedRun> runs_;
  std::vector<WatchedLocalizer> localizers_;
};

}  // namespace fleetloc
