#include "deploy/evaluation/experiment/result_figures.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <utility>

#include "deploy/evaluation/report/box_figure.hpp"
#include "deploy/evaluation/report/html.hpp"
#include "deploy/evaluation/report/run_data.hpp"
#include "shared/trajectory/tum_file.hpp"

namespace fleetloc {
namespace {

/// Errors of position of all frames of all seeds of a group [m].
struct Errors {
  std::vector<double> localized;
  std::vector<double> aligned_once;
  std::vector<double> odometry;
};

void append(const std::vector<PosePair>& pairs, std::vector<double>& errors) {
  for (const PosePair& pair : pairs) errors.push_back(position_error(pair).norm());
}

BoxGroup boxes_of(const Group& group, const std::string& label, const Inputs& inputs) {
  const Duration max_gap = from_seconds(0.15);  // as fleetloc-eval
  Errors errors;
  std::string dataset;
  Trajectory truth;
  for (const Result* result : group.results) {
    if (const std::string& name = result->run->dataset->name; name != dataset) {
      dataset = name;
      truth = read_trajectory(inputs.dataset(name).ground_truth);
    }
    const RunErrors its = errors_of(read_run(result->folder), truth, max_gap);
    append(its.localized, errors.localized);
    append(its.aligned_once, errors.aligned_once);
    append(its.odometry, errors.odometry);
  }
  return {
      .label = label,
      .boxes = {box_of(errors.localized), box_of(errors.aligned_once), box_of(errors.odometry)}};
}

/// The axis that a figure is drawn over.
struct Axis {
  std::string name;
  std::function<std::string(const Run&)> value;
};

std::array<Axis, 3> axes() {
  return {Axis{"dataset", [](const Run& run) { return run.dataset->group; }},
          Axis{"configuration", [](const Run& run) { return run.configuration->name; }},
          Axis{"link", [](const Run& run) { return run.link->name; }}};
}

/// Links first, since the paper draws over them; an axis with one value is no axis.
Axis horizontal_axis(const Plan& plan) {
  const auto [dataset, configuration, link] = axes();
  if (plan.links.size() > 1) return link;
  const auto localized = [](const ConfigurationSpec& spec) { return !spec.odometry_only; };
  if (std::ranges::count_if(plan.configurations, localized) > 1) return configuration;
  return dataset;
}

/// A figure, and what all its boxes have in common.
struct Panel {
  std::string name;
  BoxFigure figure;
};

std::string panel_name(const Run& run, const Axis& across) {
  std::string name;
  for (const Axis& axis : axes()) {
    if (axis.name != across.name) name += (name.empty() ? "" : ", ") + axis.value(run);
  }
  return name;
}

Panel& panel_of(const Run& run, const Axis& across, std::vector<Panel>& panels) {
  const std::string name = panel_name(run, across);
  const auto found = std::ranges::find(panels, name, &Panel::name);
  if (found != panels.end()) return *found;
  return panels.emplace_back(
      Panel{.name = name,
            .figure = {.id = "boxes" + std::to_string(panels.size() + 1),
                       .title = "errors of position over " + across.name + ": " + name,
                       .x_label = across.name,
                       .y_label = "error of position [m]",
                       .series = {"localized", "aligned once", "odometry"},
                       .groups = {}}});
}

}  // namespace

std::string box_figures(const Plan& plan, const std::vector<Group>& groups, const Inputs& inputs) {
  const Axis across = horizontal_axis(plan);
  std::vector<Panel> panels;
  for (const Group& group : groups) {
    if (group.results.empty()) continue;
    panel_of(*group.run, across, panels)
        .figure.groups.push_back(boxes_of(group, across.value(*group.run), inputs));
  }
  std::string html;
  for (const auto& [name, figure] : panels) {
    const std::string svg = box_figure(figure);
    if (svg.empty()) continue;
    html += "<figure>\n" + svg + "<figcaption><strong>" + escaped(name) +
            ".</strong> Error of position over " + across.name + ".</figcaption>\n</figure>\n";
  }
  return html;
}

}  // namespace fleetloc
