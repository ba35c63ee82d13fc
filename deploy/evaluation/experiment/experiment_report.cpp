#include "deploy/evaluation/experiment/experiment_report.hpp"

#include <iomanip>
#include <optional>
#include <sstream>

#include "deploy/evaluation/experiment/pages.hpp"
#include "deploy/evaluation/experiment/place_tables.hpp"
#include "deploy/evaluation/experiment/result_figures.hpp"
#include "deploy/evaluation/experiment/result_groups.hpp"
#include "deploy/evaluation/experiment/result_tables.hpp"
#include "deploy/evaluation/report/html.hpp"
#include "deploy/evaluation/report/template.hpp"

namespace fleetloc {

std::string experiment_page(const Plan& plan,
                            const std::string& plan_text,
                            const std::vector<Result>& results,
                            const Inputs& inputs,
                            std::size_t expected) {
  const std::vector<Group> groups = groups_of(results);
  const std::size_t missing = expected - results.size();
  TemplateValues values{
      {"title", escaped(plan.title)},
      {"description", escaped(plan.description)},
      {"style", std::string(kStyleCss)},
      {"counts",
       std::to_string(plan.datasets.size()) + " datasets, " +
           std::to_string(plan.configurations.size()) + " configurations, " +
           std::to_string(plan.links.size()) + " links, " + std::to_string(plan.seeds.size()) +
           " seeds: " + std::to_string(expected) + " runs, " +
           (plan.mode == Mode::kDds ? "over DDS in real time" : "replayed in simulated time") +
           "."},
      {"table", error_table(plan, groups)},
      {"places", place_table(plan, groups)},
      {"wrong_places", wrong_place_table(results)},
      {"carried", carried_table(plan, groups)},
      {"figures", box_figures(plan, groups, inputs)},
      {"traffic", traffic_table(plan, groups)},
      {"failures", failure_table(results)},
      {"plan", escaped(plan_text)}};
  if (missing > 0) {
    values["missing"] = std::to_string(missing) +
                        " runs have not been made yet; the same command continues with them.";
  }
  return filled(kExperimentHtml, values);
}

std::string error_lines(const std::vector<Result>& results) {
  std::ostringstream text;
  constexpr int kName = 44;
  text << std::left << std::setw(kName) << "dataset configuration link" << std::right;
  for (const char* name : {"median", "std", "max", "once", "ratio", "odometry"}) {
    text << std::setw(10) << name;
  }
  text << '\n';
  const auto print = [&text](const std::optional<double>& value) {
    text << std::setw(10);
    if (value) {
      text << std::fixed << std::setprecision(3) << *value;
    } else {
      text << "-";
    }
  };
  for (const Group& group : groups_of(results)) {
    const Run& run = *group.run;
    text << std::left << std::setw(kName)
         << run.dataset->group + " " + run.configuration->name + " " + run.link->name << std::right;
    const auto evaluation = &Result::evaluation;
    print(mean_of(group, evaluation, "/ate/median"));
    print(mean_of(group, evaluation, "/ate/std"));
    print(max_of(group, evaluation, "/ate/max"));
    print(mean_of(group, evaluation, "/aligned_once/ate/median"));
    print(min_of(group, evaluation, "/aligned_once/ratio/median"));
    print(mean_of(group, evaluation, "/odometry_ate/median"));
    text << '\n';
  }
  return text.str() + place_lines(results);
}

}  // namespace fleetloc
