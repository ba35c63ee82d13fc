#pragma once

#include <cstdint>
#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include "deploy/evaluation/experiment/inputs.hpp"
#include "deploy/evaluation/experiment/plan.hpp"
#include "deploy/evaluation/experiment/programs.hpp"

namespace fleetloc {

/// One element of the matrix.
struct Run {
  const DatasetSpec* dataset;
  const ConfigurationSpec* configuration;
  const LinkSpec* link;
  std::uint64_t seed = 0;
  double start_s = 0.0;  ///< of the dataset to skip
  bool is_told = true;   ///< where it starts
  std::string identity;  ///< hash of all that it depends on; runs with the same one are the same

  [[nodiscard]] std::string name() const;
};

/// All runs of a plan, in the order dataset, configuration, link, seed, start. The plan must
/// outlive them.
std::vector<Run> runs_of(const Plan& plan, const Inputs& inputs, const Programs& programs);

/// Its link, with its seed; a perfect one where the baseline takes its place.
LinkConfig link_of(const Run& run);

/// Inputs of a run.
struct RunContext {
  const Plan* plan;
  const Inputs* inputs;
  const Programs* programs;
  std::filesystem::path runs;  ///< folder of all runs
};

/// A run that ended well lies in `<runs>/<identity>`, one that failed in
/// `<runs>/<identity>.failed`.
std::filesystem::path finished_folder(const std::filesystem::path& runs, const Run& run);
std::filesystem::path failed_folder(const std::filesystem::path& runs, const Run& run);

/// Plays the dataset and compares with the ground truth, which only that comparison sees. Returns a
/// line for the user. Throws Interrupted, and then nothing is left of the run.
/// @param slot  tells runs at the same time apart
std::string perform(const Run& run,
                    const RunContext& context,
                    const std::stop_token& stop,
                    int slot);

}  // namespace fleetloc
