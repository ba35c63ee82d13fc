#pragma once

#include <optional>
#include <string>
#include <vector>

#include "deploy/evaluation/experiment/results.hpp"

namespace fleetloc {

/// Results that differ in their seed or start alone, or are trials of one dataset.
struct Group {
  const Run* run;                      ///< any of them
  std::vector<const Result*> results;  ///< that ended well
};

/// In the order of the results.
std::vector<Group> groups_of(const std::vector<Result>& results);

/// The value of each result that has it.
std::vector<double> values_of(const Group& group,
                              nlohmann::json Result::*source,
                              const std::string& pointer);

/// Nothing if no result has it.
std::optional<double> mean_of(const Group& group,
                              nlohmann::json Result::*source,
                              const std::string& pointer);
std::optional<double> min_of(const Group& group,
                             nlohmann::json Result::*source,
                             const std::string& pointer);
std::optional<double> max_of(const Group& group,
                             nlohmann::json Result::*source,
                             const std::string& pointer);

}  // namespace fleetloc
