#include "deploy/evaluation/report/tables.hpp"

#include <algorithm>
#include <array>

#include "deploy/evaluation/report/html.hpp"

namespace fleetloc {
namespace {

using nlohmann::json;
using Cells = std::vector<std::vector<std::string>>;

constexpr const char* kNone = "–";

std::string cell(const json& value, int digits = 4) {
  if (value.is_null()) return kNone;
  if (value.is_number_float()) return number_text(value.get<double>(), digits);
  if (value.is_string()) return escaped(value.get<std::string>());
  if (value.is_structured() && value.empty()) return "none";
  return escaped(value.dump());
}

/// A value by its path, null if it is not there.
json at(const json& object, const std::string& path) {
  const json::json_pointer pointer(path);
  return object.contains(pointer) ? object.at(pointer) : json();
}

std::string key(const std::string& name) {
  return "<code>" + escaped(name) + "</code>";
}

void add_flattened(const json& object, const std::string& prefix, Cells& rows) {
  for (const auto& [name, value] : object.items()) {
    if (value.is_object() && !value.empty()) {
      add_flattened(value, prefix + name + ".", rows);
    } else {
      rows.push_back({key(prefix + name), cell(value, 6)});
    }
  }
}

bool is_statistics(const json& value) {
  return value.is_object() && value.contains("rmse") && value.contains("std");
}

/// {"a": statistics, "b": {"c": statistics}}: the rows a and b.c.
void add_statistics(const json& object, const std::string& prefix, Cells& rows) {
  for (const auto& [name, value] : object.items()) {
    if (is_statistics(value)) {
      rows.push_back({key(prefix + name)});
      for (const char* which : {"median", "mean", "rmse", "std", "max"}) {
        rows.back().push_back(cell(value.at(which)));
      }
    } else if (value.is_object()) {
      add_statistics(value, prefix + name + ".", rows);
    }
  }
}

json without_statistics(const json& object) {
  json rest = json::object();
  for (const auto& [name, value] : object.items()) {
    if (is_statistics(value)) continue;
    if (value.is_object() && !value.empty()) {
      json inner = without_statistics(value);
      if (!inner.empty()) rest[name] = std::move(inner);
    } else {
      rest[name] = value;
    }
  }
  return rest;
}

json per_second(const json& summary, const char* bytes) {
  const json length = at(summary, "/duration_s");
  const json sum = at(summary, std::string("/") + bytes);
  if (!length.is_number() || !sum.is_number() || length.get<double>() <= 0.0) return {};
  return 1e-3 * sum.get<double>() / length.get<double>();
}

json percent(const json& share) {
  return share.is_number() ? json(100.0 * share.get<double>()) : json();
}

std::string pair_name(std::string localizer, const std::string& robot) {
  return localizer.append(" / ").append(robot);
}

}  // namespace

std::string values_table(const json& figures) {
  Cells rows;
  add_flattened(figures, "", rows);
  return table({"figure", "value"}, rows);
}

std::string error_table(const json& evaluation) {
  Cells rows;
  add_statistics(evaluation, "", rows);
  return rows.empty() ? "" : table({"error", "median", "mean", "rmse", "std", "max"}, rows);
}

std::string other_evaluation_table(const json& evaluation) {
  const json rest = without_statistics(evaluation);
  return rest.empty() ? "" : values_table(rest);
}

std::string summary_table(const std::vector<SummaryRow>& runs) {
  Cells rows;
  for (const SummaryRow& run : runs) {
    const json& summary = run.summary;
    const json& evaluation = run.evaluation;
    rows.push_back(
        {"<a href=\"#" + run.anchor + "\">" + escaped(run.name) + "</a>",
         cell(at(summary, "/duration_s")),
         cell(percent(at(evaluation, "/covered")), 3),
         cell(at(evaluation, "/ate/median"), 3),
         cell(at(evaluation, "/ate/rmse"), 3),
         cell(at(evaluation, "/ate/max"), 3),
         cell(at(evaluation, "/rotation_deg/median"), 3),
         cell(at(evaluation, "/aligned_once/ate/rmse"), 3),
         cell(at(evaluation, "/aligned_once/ratio/median"), 3) + " / " +
             cell(at(evaluation, "/aligned_once/ratio/rmse"), 3),
         cell(at(evaluation, "/odometry_ate/rmse"), 3),
         cell(at(summary, "/answers_applied")) + " / " + cell(at(summary, "/answers_received")),
         cell(per_second(summary, "uplink_bytes"), 3),
         cell(per_second(summary, "downlink_bytes"), 3),
         cell(at(summary, "/cpu_ms_per_frame"), 3),
         cell(at(summary, "/resets"))});
  }
  return table({"run",
                "data [s]",
                "covered [%]",
                "error median [m]",
                "rmse [m]",
                "max [m]",
                "rotation median [deg]",
                "aligned once rmse [m]",
                "ratio, median / rmse",
                "odometry se3 rmse [m]",
                "answers applied",
                "up [kB/s]",
                "down [kB/s]",
                "cpu [ms/frame]",
                "resets"},
               rows);
}

std::string sessions_table(const std::vector<Sessions>& sessions) {
  Cells rows;
  for (const auto& [localizer, robots] : sessions) {
    for (const auto& [robot, figures] : robots.items()) {
      rows.push_back({escaped(pair_name(localizer, robot))});
      for (const char* path : {"/submaps",
                               "/localized",
                               "/rejected",
                               "/optimize_ms/p50",
                               "/optimize_ms/p99",
                               "/matches/p50",
                               "/memory_bytes"}) {
        rows.back().push_back(cell(at(figures, path)));
      }
    }
  }
  return rows.empty() ? ""
                      : table({"localizer / robot",
                               "submaps",
                               "localized",
                               "rejected",
                               "p50 [ms]",
                               "p99 [ms]",
                               "matches p50",
                               "memory [bytes]"},
                              rows);
}

std::vector<SessionRow> session_rows(const std::vector<Sessions>& sessions) {
  std::vector<SessionRow> rows;
  for (const auto& [localizer, robots] : sessions) {
    for (const auto& [robot, figures] : robots.items()) {
      const json p50 = at(figures, "/optimize_ms/p50");
      const json p99 = at(figures, "/optimize_ms/p99");
      if (!p50.is_number() || !p99.is_number()) continue;
      rows.push_back({pair_name(localizer, robot), p50.get<double>(), p99.get<double>()});
    }
  }
  return rows;
}

}  // namespace fleetloc
