#include "deploy/evaluation/experiment/place_tables.hpp"

#include <algorithm>
#include <iomanip>
#include <sstream>

#include "deploy/evaluation/errors/eval_place.hpp"
#include "deploy/evaluation/errors/trajectory_error.hpp"
#include "deploy/evaluation/experiment/axis_cells.hpp"
#include "deploy/evaluation/report/html.hpp"
#include "shared/core/exact_text.hpp"

namespace fleetloc {
namespace {

constexpr auto kOf = &Result::evaluation;
constexpr double kNear_m = 20.0;
constexpr double kFar_m = 40.0;
constexpr double kSoon_s = 10.0;

bool took_a_wrong_place(const Result& result) {
  const auto value = [&result](const char* pointer) {
    const nlohmann::json number = number_at(result.evaluation, pointer);
    return number.is_number() ? number.get<double>() : 0.0;
  };
  return value("/first_place/error_m") > kPlaceMetres ||
         value("/first_place/error_deg") > kPlaceDegrees ||
         value("/first_place/wrong_frames") > 0.0;
}

/// Share of the results with a value of at most `limit`.
std::string share_within(const Group& group, const char* pointer, double limit) {
  const auto values = values_of(group, kOf, pointer);
  const auto within =
      std::ranges::count_if(values, [limit](double value) { return value <= limit; });
  return number_text(
      100.0 * static_cast<double>(within) / static_cast<double>(group.results.size()), 3);
}

std::string median(const Group& group, const char* pointer) {
  const auto values = values_of(group, kOf, pointer);
  return values.empty() ? kNoValue : number_text(statistics(values).median, 3);
}

std::string largest(const Group& group, const char* pointer) {
  const auto value = max_of(group, kOf, pointer);
  return value ? number_text(*value, 3) : kNoValue;
}

Cells place_header() {
  return {"starts",
          "found",
          "within 20 m [%]",
          "within 40 m [%]",
          "median [m]",
          "last [m]",
          "median [s]",
          "last [s]",
          "wrong"};
}

Cells place_cells(const Group& group) {
  const auto wrong = std::ranges::count_if(
      group.results, [](const Result* result) { return took_a_wrong_place(*result); });
  return {std::to_string(group.results.size()),
          std::to_string(values_of(group, kOf, "/first_place/way_m").size()),
          share_within(group, "/first_place/way_m", kNear_m),
          share_within(group, "/first_place/way_m", kFar_m),
          median(group, "/first_place/way_m"),
          largest(group, "/first_place/way_m"),
          median(group, "/first_place/after_s"),
          largest(group, "/first_place/after_s"),
          std::to_string(wrong)};
}

Cells carried_header() {
  return {"trials",
          "noticed within 10 s [%]",
          "noticed, last [s]",
          "wrong and sure, median [s]",
          "longest [s]",
          "right again",
          "median [s]",
          "last [s]",
          "median [m]",
          "last [m]"};
}

Cells carried_cells(const Group& group) {
  return {std::to_string(values_of(group, kOf, "/carried_away/distance_m").size()),
          share_within(group, "/carried_away/noticed_s", kSoon_s),
          largest(group, "/carried_away/noticed_s"),
          median(group, "/carried_away/wrong_and_sure_s"),
          largest(group, "/carried_away/wrong_and_sure_s"),
          std::to_string(values_of(group, kOf, "/carried_away/right_s").size()),
          median(group, "/carried_away/right_s"),
          largest(group, "/carried_away/right_s"),
          median(group, "/carried_away/right_m"),
          largest(group, "/carried_away/right_m")};
}

bool looks_for_its_start(const Group& group) {
  return !group.run->is_told && !group.results.empty();
}

bool was_carried(const Group& group) {
  return !values_of(group, kOf, "/carried_away/distance_m").empty();
}

using OfGroup = bool (*)(const Group& group);
using CellsOf = Cells (*)(const Group& group);

std::string group_table(const Plan& plan,
                        const std::vector<Group>& groups,
                        OfGroup is_in,
                        const Cells& header,
                        CellsOf cells_of) {
  std::vector<Cells> rows;
  for (const Group& group : groups) {
    if (!is_in(group)) continue;
    Cells row = axes_of(plan, *group.run);
    const Cells cells = cells_of(group);
    row.insert(row.end(), cells.begin(), cells.end());
    rows.push_back(row);
  }
  return rows.empty() ? "" : table(header_of(plan, header), rows);
}

void print_groups(std::ostream& text,
                  const std::vector<Group>& groups,
                  OfGroup is_in,
                  const Cells& header,
                  CellsOf cells_of) {
  for (const Group& group : groups) {
    if (!is_in(group)) continue;
    const Run& run = *group.run;
    text << run.dataset->group << ' ' << run.configuration->name << ' ' << run.link->name << ':';
    const Cells cells = cells_of(group);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      text << (i == 0 ? " " : ", ") << header[i] << ' ' << cells[i];
    }
    text << '\n';
  }
}

}  // namespace

std::string place_table(const Plan& plan, const std::vector<Group>& groups) {
  return group_table(plan, groups, looks_for_its_start, place_header(), place_cells);
}

std::string carried_table(const Plan& plan, const std::vector<Group>& groups) {
  return group_table(plan, groups, was_carried, carried_header(), carried_cells);
}

std::string wrong_place_table(const std::vector<Result>& results) {
  std::vector<Cells> rows;
  for (const Result& result : results) {
    if (!result.failure.empty() || result.run->is_told || !took_a_wrong_place(result)) continue;
    const auto value = [&result](const char* pointer) {
      const nlohmann::json number = number_at(result.evaluation, pointer);
      return number.is_number() ? number_text(number.get<double>(), 3) : kNoValue;
    };
    rows.push_back({escaped(result.run->name()),
                    value("/first_place/way_m"),
                    value("/first_place/error_m"),
                    value("/first_place/error_deg"),
                    value("/first_place/wrong_frames"),
                    escaped(result.folder.filename().string())});
  }
  return rows.empty() ? ""
                      : table({"run",
                               "first place after [m]",
                               "off by [m]",
                               "off by [deg]",
                               "frames wrong and localized",
                               "folder"},
                              rows);
}

std::string place_lines(const std::vector<Result>& results) {
  const std::vector<Group> groups = groups_of(results);
  std::ostringstream text;
  print_groups(text, groups, looks_for_its_start, place_header(), place_cells);
  print_groups(text, groups, was_carried, carried_header(), carried_cells);
  return text.str();
}

}  // namespace fleetloc
