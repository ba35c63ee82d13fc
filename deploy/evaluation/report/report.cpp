#include "deploy/evaluation/report/report.hpp"

#include <algorithm>

#include "cloud/point_cloud/point_cloud_file.hpp"
#include "deploy/evaluation/report/configuration_table.hpp"
#include "deploy/evaluation/report/figures.hpp"
#include "deploy/evaluation/report/html.hpp"
#include "deploy/evaluation/report/pages.hpp"
#include "deploy/evaluation/report/tables.hpp"
#include "deploy/evaluation/report/template.hpp"

namespace fleetloc {
namespace {

using Points = std::vector<Eigen::Vector3f>;

/// What all runs have in common.
struct Common {
  Points map;
  Duration max_gap;
};

/// What the sections of the page need of a run's place in the report.
struct Place {
  std::string anchor;  ///< id of its section
  std::string prefix;  ///< of the ids within
};

Place place_of(std::size_t index) {
  const std::string anchor = "run" + std::to_string(index + 1);
  return {.anchor = anchor, .prefix = anchor + "-"};
}

void add_figures_with_truth(const RunData& run,
                            const ReportRun& input,
                            const Common& common,
                            const std::string& prefix,
                            TemplateValues& values) {
  const RunErrors errors = errors_of(run, *input.truth, common.max_gap);
  const TrajectoryFigures trajectories = trajectory_figures(errors, common.map, prefix);
  const ConsistencyFigure consistency = consistency_figure(run, errors, prefix);
  values["localized"] = trajectories.localized;
  values["aligned_once"] = trajectories.aligned_once;
  values["odometry"] = trajectories.odometry;
  values["comparison"] = comparison_figure(run, errors, prefix);
  values["consistency"] = consistency.svg;
  values["share_within"] = number_text(100.0 * consistency.share_within, 3);
  for (const std::string which : {"median", "rmse"}) {
    const auto ratio = nlohmann::json::json_pointer("/aligned_once/ratio/" + which);
    if (!input.evaluation.contains(ratio) || !input.evaluation.at(ratio).is_number()) continue;
    values["ratio_" + which] = number_text(input.evaluation.at(ratio).get<double>(), 3);
  }
}

/// The comment that a program puts before its configuration.
std::string command_line(const std::string& config) {
  const std::string first = config.substr(0, config.find('\n'));
  return first.starts_with("# ") ? first.substr(2) : "";
}

std::string run_section(const RunData& run,
                        const ReportRun& input,
                        const Common& common,
                        const Place& place) {
  TemplateValues values{{"anchor", place.anchor},
                        {"name", escaped(run.name)},
                        {"folder", escaped(input.folder.generic_string())},
                        {"truth", input.truth ? "yes" : ""},
                        {"map", common.map.empty() ? "" : "yes"},
                        {"was_localized", run.localized.empty() ? "" : "yes"},
                        {"states", states_figure(run, place.prefix)},
                        {"bytes", bytes_figure(run, place.prefix)},
                        {"link", link_figure(run, place.prefix)},
                        {"summary", values_table(run.summary)}};
  if (input.truth) {
    add_figures_with_truth(run, input, common, place.prefix, values);
  } else {
    values["uncoloured"] = trajectory_figure(run, common.map, place.prefix);
  }
  if (!input.evaluation.is_null()) {
    values["errors"] = error_table(input.evaluation);
    values["evaluation"] = other_evaluation_table(input.evaluation);
  }
  if (run.config) {
    values["config"] = escaped(*run.config);
    values["command_line"] = escaped(command_line(*run.config));
    values["differences"] = configuration_differences(*run.config);
  }
  return filled(kRunHtml, values);
}

/// The folder's name is the localizer's; a replay's localizer lies in the folder of its run.
std::vector<Sessions> read_sessions(const ReportInput& input) {
  std::vector<std::filesystem::path> files = input.sessions;
  for (const ReportRun& run : input.runs) {
    const auto file = run.folder / "sessions.json";
    const auto is_same = [&file](const auto& other) {
      return std::filesystem::weakly_canonical(other) == std::filesystem::weakly_canonical(file);
    };
    if (std::filesystem::exists(file) && std::ranges::none_of(files, is_same)) {
      files.push_back(file);
    }
  }
  std::vector<Sessions> sessions;
  for (const auto& file : files) {
    const std::string name = file.lexically_normal().parent_path().filename().string();
    sessions.push_back({name.empty() ? file.string() : name, read_json(file)});
  }
  return sessions;
}

}  // namespace

std::string report_page(const ReportInput& input) {
  const Common common{.map = input.map ? read_points(*input.map) : Points{},
                      .max_gap = input.max_gap};
  const std::vector<Sessions> sessions = read_sessions(input);
  std::vector<SummaryRow> rows;
  std::string sections;
  for (std::size_t i = 0; i < input.runs.size(); ++i) {
    const ReportRun& its = input.runs[i];
    const RunData run = read_run(its.folder);
    const Place place = place_of(i);
    rows.push_back({run.name, place.anchor, run.summary, its.evaluation});
    sections += run_section(run, its, common, place);
  }
  const bool some_without_truth =
      std::ranges::any_of(input.runs, [](const ReportRun& run) { return !run.truth; });
  return filled(kPageHtml,
                {{"style", std::string(kStyleCss)},
                 {"summary", summary_table(rows)},
                 {"without_truth", some_without_truth ? "yes" : ""},
                 {"runs", sections},
                 {"sessions_table", sessions_table(sessions)},
                 {"sessions", session_figure(session_rows(sessions), "sessions-figure")}});
}

}  // namespace fleetloc
