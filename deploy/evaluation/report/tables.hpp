#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "deploy/evaluation/report/figures.hpp"

namespace fleetloc {

/// Every value of a JSON object, in the order of its keys; those of inner objects as `outer.inner`.
std::string values_table(const nlohmann::json& figures);

/// Of evaluation.json: one row for each of the errors it holds, and the other values.
std::string error_table(const nlohmann::json& evaluation);
std::string other_evaluation_table(const nlohmann::json& evaluation);

/// One row a run, for the top of a report. Null: there is no evaluation.
struct SummaryRow {
  std::string name;
  std::string anchor;  ///< id of its section
  nlohmann::json summary;
  nlohmann::json evaluation;
};
std::string summary_table(const std::vector<SummaryRow>& runs);

/// sessions.json of the localizers, by their name.
struct Sessions {
  std::string localizer;
  nlohmann::json robots;
};
std::string sessions_table(const std::vector<Sessions>& sessions);
std::vector<SessionRow> session_rows(const std::vector<Sessions>& sessions);

}  // namespace fleetloc
