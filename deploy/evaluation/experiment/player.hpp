#pragma once

#include <filesystem>
#include <stop_token>

#include "deploy/evaluation/experiment/run.hpp"

namespace fleetloc {

/// Run folder and slot of a run.
struct Place {
  std::filesystem::path folder;  ///< becomes its run folder
  int slot = 0;
};

/// Runs the programs under test: fleetloc-replay, or fleetloc-cloud and fleetloc-robot over DDS.
/// They never see the ground truth. Throws Interrupted and ProgramFailed.
void play(const Run& run,
          const RunContext& context,
          const Place& place,
          const std::stop_token& stop);

}  // namespace fleetloc
