#pragma once

#include <optional>

#include <nlohmann/json_fwd.hpp>

#include "robot/run_folder/run_folder.hpp"

namespace fleetloc {

/// Times of a run that follow from its records.
struct RunTimes {
  double duration_s = 0.0;
  std::optional<double> first_pose_s;          ///< since the first frame
  std::optional<double> first_answer_s;        ///< of any status, since the first frame
  std::optional<double> first_localization_s;  ///< since the first frame
  std::optional<double> coverage;
};

nlohmann::json to_json(const RunSummary& summary, const RunTimes& times);

}  // namespace fleetloc
