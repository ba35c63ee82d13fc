#include "deploy/evaluation/experiment/results.hpp"

#include <array>

#include "deploy/evaluation/experiment/programs.hpp"
#include "shared/core/exact_text.hpp"

namespace fleetloc {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct Column {
  const char* name;
  json Result::*source;
  const char* pointer;
};

constexpr auto kEvaluation = &Result::evaluation;
constexpr auto kSummary = &Result::summary;
constexpr auto kSession = &Result::session;

constexpr std::array kFigures{
    Column{"ate_median_m", kEvaluation, "/ate/median"},
    Column{"ate_mean_m", kEvaluation, "/ate/mean"},
    Column{"ate_rmse_m", kEvaluation, "/ate/rmse"},
    Column{"ate_std_m", kEvaluation, "/ate/std"},
    Column{"ate_max_m", kEvaluation, "/ate/max"},
    Column{"rotation_median_deg", kEvaluation, "/rotation_deg/median"},
    Column{"rotation_rmse_deg", kEvaluation, "/rotation_deg/rmse"},
    Column{"rotation_max_deg", kEvaluation, "/rotation_deg/max"},
    Column{"odometry_ate_median_m", kEvaluation, "/odometry_ate/median"},
    Column{"odometry_ate_rmse_m", kEvaluation, "/odometry_ate/rmse"},
    Column{"odometry_ate_max_m", kEvaluation, "/odometry_ate/max"},
    Column{"odometry_relative_rmse_m", kEvaluation, "/odometry_relative/translation_rmse_m"},
    Column{"aligned_once_ate_median_m", kEvaluation, "/aligned_once/ate/median"},
    Column{"aligned_once_ate_rmse_m", kEvaluation, "/aligned_once/ate/rmse"},
    Column{"aligned_once_ratio_median", kEvaluation, "/aligned_once/ratio/median"},
    Column{"aligned_once_ratio_rmse", kEvaluation, "/aligned_once/ratio/rmse"},
    Column{"covered", kEvaluation, "/covered"},
    Column{"coverage", kSummary, "/coverage"},
    Column{"nees_map", kEvaluation, "/nees/map"},
    Column{"nees_odom", kEvaluation, "/nees/odom"},
    Column{"localized_wrong", kEvaluation, "/confidence/wrong"},
    Column{"confidently_wrong", kEvaluation, "/confidence/confidently_wrong"},
    Column{"first_place_s", kEvaluation, "/first_place/after_s"},
    Column{"first_place_m", kEvaluation, "/first_place/way_m"},
    Column{"first_place_error_m", kEvaluation, "/first_place/error_m"},
    Column{"first_place_error_deg", kEvaluation, "/first_place/error_deg"},
    Column{"wrong_place_frames", kEvaluation, "/first_place/wrong_frames"},
    Column{"carried_m", kEvaluation, "/carried_away/distance_m"},
    Column{"noticed_s", kEvaluation, "/carried_away/noticed_s"},
    Column{"wrong_and_sure_s", kEvaluation, "/carried_away/wrong_and_sure_s"},
    Column{"right_again_s", kEvaluation, "/carried_away/right_s"},
    Column{"right_again_m", kEvaluation, "/carried_away/right_m"},
    Column{"uplink_bytes", kSummary, "/uplink_bytes"},
    Column{"downlink_bytes", kSummary, "/downlink_bytes"},
    Column{"uplink_wire_bytes", kSummary, "/uplink_wire_bytes"},
    Column{"downlink_wire_bytes", kSummary, "/downlink_wire_bytes"},
    Column{"submaps_sent", kSummary, "/submaps_sent"},
    Column{"answers_applied", kSummary, "/answers_applied"},
    Column{"answers_received", kSummary, "/answers_received"},
    Column{"first_answer_s", kSummary, "/first_answer_s"},
    Column{"first_localization_s", kSummary, "/first_localization_s"},
    Column{"resets", kSummary, "/resets"},
    Column{"optimize_p50_ms", kSession, "/optimize_ms/p50"},
    Column{"optimize_p99_ms", kSession, "/optimize_ms/p99"},
    Column{"frames", kSummary, "/frames"},
    Column{"duration_s", kSummary, "/duration_s"},
    Column{"wall_s", kSummary, "/wall_s"},
    Column{"cpu_s", kSummary, "/cpu_s"}};

json read_json_file(const fs::path& file) {
  try {
    return json::parse(text_of(file));
  } catch (const json::exception& error) {
    throw std::runtime_error(file.string() + ": " + error.what());
  }
}

Result read_result(const Run& run, const fs::path& folder) {
  Result result{
      .run = &run, .folder = folder, .failure = {}, .summary = {}, .evaluation = {}, .session = {}};
  const json description = read_json_file(folder / "run.json");
  result.exit_status = description.at("exit_status").get<int>();
  result.failure = description.at("failure").get<std::string>();
  if (!result.failure.empty()) return result;
  result.summary = read_json_file(folder / "summary.json");
  result.evaluation = read_json_file(folder / "evaluation.json");
  const fs::path sessions = folder / "sessions.json";
  if (!fs::exists(sessions)) return result;
  const json robots = read_json_file(sessions);
  if (!robots.empty()) result.session = robots.front();
  return result;
}

std::string quoted(const std::string& text) {
  std::string field = "\"";
  for (const char c : text) {
    if (c == '"') field += '"';
    field += c == '\n' ? ' ' : c;
  }
  return field + "\"";
}

std::string axis_values(const Run& run) {
  std::string line = run.dataset->name + "," + run.dataset->map + "," + run.configuration->name +
                     "," + run.link->name + "," + std::to_string(run.seed) + "," +
                     exact_text(run.start_s);
  for (const LinkDirection& direction : {run.link->link.uplink, run.link->link.downlink}) {
    for (const double value : {direction.loss, direction.delay_s, direction.rate_bytes_per_s}) {
      line += "," + exact_text(value);
    }
  }
  return line;
}

}  // namespace

json number_at(const json& object, const std::string& pointer) {
  const json::json_pointer path(pointer);
  return object.contains(path) ? object.at(path) : json();
}

std::vector<Result> read_results(const std::vector<Run>& runs, const fs::path& folder) {
  std::vector<Result> results;
  for (const Run& run : runs) {
    for (const fs::path& candidate : {finished_folder(folder, run), failed_folder(folder, run)}) {
      if (!fs::exists(candidate)) continue;
      results.push_back(read_result(run, candidate));
      break;
    }
  }
  return results;
}

std::string results_csv(const std::vector<Result>& results) {
  std::string text =
      "dataset,map,configuration,link,seed,start_s,loss_up,latency_up_s,bandwidth_up_bytes_per_s,"
      "loss_down,"
      "latency_down_s,bandwidth_down_bytes_per_s";
  for (const Column& column : kFigures) text += std::string(",") + column.name;
  text += ",exit_status,failure,folder\n";
  for (const Result& result : results) {
    text += axis_values(*result.run);
    for (const Column& column : kFigures) {
      const json value = number_at(result.*column.source, column.pointer);
      text += "," + (value.is_number() ? value.dump() : "");
    }
    text += "," + std::to_string(result.exit_status) + "," +
            (result.failure.empty() ? "" : quoted(result.failure)) + "," +
            quoted(result.folder.filename().string()) + "\n";
  }
  return text;
}

}  // namespace fleetloc
