#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "shared/trajectory/trajectory.hpp"

namespace fleetloc {

struct ReportRun {
  std::filesystem::path folder;
  nlohmann::json evaluation;        ///< see eval_run.hpp; null: none
  std::optional<Trajectory> truth;  ///< in the frame of the map
};

struct ReportInput {
  std::vector<ReportRun> runs;
  std::optional<std::filesystem::path> map;     ///< the laser map that the trajectories lie in
  std::vector<std::filesystem::path> sessions;  ///< sessions.json of localizers
  Duration max_gap{};                           ///< that the ground truth is interpolated across
};

/// One self-contained page of HTML: figures of the runs, drawn by gnuplot, and tables. The same
/// input gives the same bytes. A replay's own sessions.json is included. Throws std::runtime_error
/// that names the file, or gnuplot.
std::string report_page(const ReportInput& input);

}  // namespace fleetloc
