#include "deploy/evaluation/experiment/result_tables.hpp"

#include <cmath>
#include <optional>

#include "deploy/evaluation/experiment/axis_cells.hpp"
#include "deploy/evaluation/report/html.hpp"

namespace fleetloc {
namespace {

std::string cell(const std::optional<double>& value, double scale = 1.0) {
  constexpr double kLarge = 1000.0;  // else three digits would need an exponent
  if (!value) return kNoValue;
  return number_text(scale * *value, std::abs(scale * *value) < kLarge ? 3 : 4);
}

/// Of bytes in a run, in kB/s.
std::optional<double> rate(const Group& group, const char* bytes) {
  const auto sum = mean_of(group, &Result::summary, bytes);
  const auto duration_s = mean_of(group, &Result::summary, "/duration_s");
  if (!sum || !duration_s || *duration_s <= 0.0) return std::nullopt;
  return 1e-3 * *sum / *duration_s;
}

}  // namespace

Cells axes_of(const Plan& plan, const Run& run) {
  Cells cells{escaped(run.dataset->group)};
  if (plan.configurations.size() > 1) cells.push_back(escaped(run.configuration->name));
  if (plan.links.size() > 1) cells.push_back(escaped(run.link->name));
  return cells;
}

Cells header_of(const Plan& plan, const Cells& others) {
  Cells names{"dataset"};
  if (plan.configurations.size() > 1) names.emplace_back("configuration");
  if (plan.links.size() > 1) names.emplace_back("link");
  names.insert(names.end(), others.begin(), others.end());
  return names;
}

std::string error_table(const Plan& plan, const std::vector<Group>& groups) {
  std::vector<Cells> rows;
  const auto evaluation = &Result::evaluation;
  for (const Group& group : groups) {
    const auto value = [&](const char* pointer) {
      return cell(mean_of(group, evaluation, pointer));
    };
    Cells row = axes_of(plan, *group.run);
    const std::size_t localized = values_of(group, evaluation, "/ate/median").size();
    row.push_back(std::to_string(localized) + " / " + std::to_string(group.results.size()));
    for (const char* pointer : {"/ate/median", "/ate/std", "/ate/rmse"}) {
      row.push_back(value(pointer));
    }
    row.push_back(cell(max_of(group, evaluation, "/ate/max")));
    for (const char* pointer : {"/rotation_deg/median", "/aligned_once/ate/median"}) {
      row.push_back(value(pointer));
    }
    row.push_back(cell(min_of(group, evaluation, "/aligned_once/ratio/median")));
    for (const char* pointer : {"/odometry_ate/median", "/odometry_ate/rmse", "/nees/map"}) {
      row.push_back(value(pointer));
    }
    row.push_back(cell(mean_of(group, evaluation, "/covered"), 100.0));
    rows.push_back(row);
  }
  return rows.empty() ? ""
                      : table(header_of(plan,
                                        {"localized runs",
                                         "median [m]",
                                         "std [m]",
                                         "rmse [m]",
                                         "max [m]",
                                         "rotation median [deg]",
                                         "aligned once median [m]",
                                         "ratio",
                                         "odometry median [m]",
                                         "odometry rmse [m]",
                                         "nees",
                                         "covered [%]"}),
                              rows);
}

std::string traffic_table(const Plan& plan, const std::vector<Group>& groups) {
  std::vector<Cells> rows;
  for (const Group& group : groups) {
    Cells row = axes_of(plan, *group.run);
    for (const char* bytes :
         {"/uplink_bytes", "/downlink_bytes", "/uplink_wire_bytes", "/downlink_wire_bytes"}) {
      row.push_back(cell(rate(group, bytes)));
    }
    const auto summary = [&](const char* pointer) {
      return cell(mean_of(group, &Result::summary, pointer));
    };
    row.push_back(summary("/answers_applied") + " / " + summary("/answers_received"));
    row.push_back(summary("/first_answer_s"));
    row.push_back(summary("/first_localization_s"));
    row.push_back(summary("/resets"));
    row.push_back(cell(mean_of(group, &Result::session, "/optimize_ms/p50")));
    row.push_back(cell(mean_of(group, &Result::session, "/optimize_ms/p99")));
    row.push_back(summary("/wall_s"));
    rows.push_back(row);
  }
  return rows.empty() ? ""
                      : table(header_of(plan,
                                        {"up [kB/s]",
                                         "down [kB/s]",
                                         "up, wire [kB/s]",
                                         "down, wire [kB/s]",
                                         "answers applied",
                                         "first answer [s]",
                                         "first localized [s]",
                                         "resets",
                                         "optimization p50 [ms]",
                                         "p99 [ms]",
                                         "wall [s]"}),
                              rows);
}

std::string failure_table(const std::vector<Result>& results) {
  std::vector<Cells> rows;
  for (const Result& result : results) {
    if (result.failure.empty()) continue;
    rows.push_back(
        {escaped(result.run->name()), std::to_string(result.exit_status), escaped(result.failure)});
  }
  return rows.empty() ? "" : table({"run", "exit status", "what it said"}, rows, false);
}

}  // namespace fleetloc
