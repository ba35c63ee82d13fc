#include <algorithm>
#include <array>
#include <cmath>

#include "deploy/evaluation/report/drawing.hpp"
#include "deploy/evaluation/report/figures.hpp"

namespace fleetloc {
namespace {

constexpr std::size_t kMaxErrorPoints = 700;  // of a line
constexpr double kDeviations = 3.0;

/// Rows for gnuplot, with an empty one in each gap.
std::vector<std::vector<double>> rows_of(const Series& series) {
  const double gap_s =
      std::max(kLongestGap_s,
               series.empty() ? 0.0
                              : 3.0 * (series.back().first - series.front().first) /
                                    static_cast<double>(kMaxErrorPoints));
  std::vector<std::vector<double>> rows;
  double before = series.empty() ? 0.0 : series.front().first;
  for (const auto& [time, value] : series) {
    if (time - before > gap_s) rows.emplace_back();
    rows.push_back({time, value});
    before = time;
  }
  return rows;
}

Series distances(const RunData& run, std::span<const PosePair> pairs) {
  Series series;
  for (const PosePair& pair : pairs) {
    series.emplace_back(run.seconds(pair.stamp), std::max(position_error(pair).norm(), 1e-4));
  }
  return thinned(series, kMaxErrorPoints);
}

/// One of x, y, z and yaw: its error and three sigmas.
struct Component {
  Series error;
  Series bound;
};

using Components = std::array<Component, 4>;

Components components_of(const RunData& run, std::span<const PosePair> pairs) {
  Components components;
  for (const PosePair& pair : pairs) {
    const auto found =
        std::ranges::lower_bound(run.covariances.map, pair.stamp, {}, &StampedCovariance::stamp);
    if (found == run.covariances.map.end() || found->stamp != pair.stamp) continue;
    const MapSigmas sigmas = map_sigmas(pair.T_estimate_body, found->covariance);
    const Eigen::Vector3d error = position_error(pair);
    const double time = run.seconds(pair.stamp);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto i = static_cast<Eigen::Index>(axis);
      components[axis].error.emplace_back(time, error(i));
      components[axis].bound.emplace_back(time, kDeviations * sigmas.position_m(i));
    }
    components[3].error.emplace_back(time, yaw_error_deg(pair));
    components[3].bound.emplace_back(time, kDeviations * sigmas.yaw_deg);
  }
  return components;
}

double share_within(const Components& components) {
  std::size_t within = 0;
  std::size_t all = 0;
  for (const Component& component : components) {
    for (std::size_t i = 0; i < component.error.size(); ++i) {
      within += std::abs(component.error[i].second) <= component.bound[i].second ? 1U : 0U;
      ++all;
    }
  }
  return all == 0 ? 0.0 : static_cast<double>(within) / static_cast<double>(all);
}

/// Half the height of a panel: all errors, and the bound but for its longest excursions.
double half_range(const Component& component) {
  double max = 0.0;
  for (const auto& [time, error] : component.error) max = std::max(max, std::abs(error));
  std::vector<double> bounds;
  for (const auto& [time, bound] : component.bound) bounds.push_back(bound);
  std::ranges::sort(bounds);
  return 1.1 * std::max({max, bounds[bounds.size() * 9 / 10], 1e-6});
}

void plot_component(Drawing& drawing,
                    const std::string& name,
                    const Component& component,
                    const std::string& label,
                    const std::string& titles) {
  const double half = half_range(component);
  const Series bound = thinned(component.bound, kMaxErrorPoints);
  drawing.data(name + "_error", rows_of(thinned(component.error, kMaxErrorPoints)));
  drawing.data(name + "_bound", rows_of(bound));
  drawing.command("set yrange [" + plot_number(-half) + ":" + plot_number(half) + "]");
  drawing.command("set ytics " + plot_number(tic_step(2.0 * half, 5)));
  drawing.command("set ylabel " + plot_string(label) + " offset 0.5,0");
  const std::string limit = " with lines linewidth 1.4 dashtype 3 linecolor rgb '" +
                            std::string(colour::kVermillion) + "' ";
  drawing.command("plot $" + name + "_bound using 1:2:(-$2) with filledcurves fillcolor rgb '" +
                  colour::kOrange + "' fillstyle transparent solid 0.18 notitle, $" + name +
                  "_bound using 1:2" + limit + (titles.empty() ? "notitle" : "title '3 sigma'") +
                  ", $" + name + "_bound using 1:(-$2)" + limit + "notitle, $" + name +
                  "_error using 1:2 with lines linewidth 1.3 linecolor rgb '" + colour::kBlue +
                  "' " + (titles.empty() ? "notitle" : titles));
}

}  // namespace

std::string comparison_figure(const RunData& run, const RunErrors& errors, const std::string& id) {
  struct Line {
    const char* name;
    Series series;
    const char* style;
  };
  const std::array<Line, 3> lines{
      Line{"odometry",
           distances(run, errors.odometry),
           "linewidth 1.6 dashtype 3 linecolor rgb '#009E73' title 'odometry'"},
      Line{"once",
           distances(run, errors.aligned_once),
           "linewidth 1.6 dashtype 2 linecolor rgb '#D55E00' title 'aligned once'"},
      Line{"localized",
           distances(run, errors.localized),
           "linewidth 1.6 linecolor rgb '#0072B2' title 'localized'"}};
  Drawing drawing(id + "comparison", "errors of position over time", 300);
  drawing.command("set logscale y\nset format y '%g'\nset xlabel 'time [s]' offset 0,0.4");
  drawing.command("set ylabel 'error of position [m]'\nset key width -3");
  std::string plot;
  std::vector<double> values;
  for (const auto& [name, series, style] : lines) {
    if (series.empty()) continue;
    for (const auto& [time, error] : series) values.push_back(error);
    drawing.data(name, rows_of(series));
    plot += std::string(plot.empty() ? "plot $" : ", $") + name + " with lines " + style;
  }
  if (plot.empty()) return "";
  std::ranges::sort(values);
  // The odometry starts with no error at all.
  const double min = rounded_down(values[values.size() / 25]);
  const double max = rounded_up(1.05 * std::max(values.back(), 2.0 * min));
  drawing.command("set yrange [" + plot_number(min) + ":" + plot_number(max) + "]");
  const bool is_short = max < 1e3 * min;  // else decades are enough
  if (is_short) drawing.command("set ytics (" + log_tics(min, max) + ")");
  drawing.command(plot);
  return drawing.svg();
}

ConsistencyFigure consistency_figure(const RunData& run,
                                     const RunErrors& errors,
                                     const std::string& id) {
  const Components components = components_of(run, errors.localized);
  if (components[0].error.empty()) return {};
  constexpr int kHeight_px = 720;
  Drawing drawing(id + "consistency", "errors and three sigmas over time", kHeight_px);
  const double begin = components[0].error.front().first;
  const double end = std::max(components[0].error.back().first, begin + 1.0);
  drawing.command("set xrange [" + plot_number(begin) + ":" + plot_number(end) + "]");
  drawing.command(
      "set multiplot layout 4,1 margins screen 0.18,0.97,0.075,0.95 spacing screen 0.025\n"
      "set format x ''");
  const std::array<const char*, 4> labels{"x [m]", "y [m]", "z [m]", "yaw [deg]"};
  for (std::size_t i = 0; i < components.size(); ++i) {
    if (i + 1 == components.size()) {
      drawing.command("set format x '%g'\nset xlabel 'time [s]' offset 0,0.4");
    }
    plot_component(
        drawing, "c" + std::to_string(i), components[i], labels[i], i == 0 ? "title 'error'" : "");
  }
  drawing.command("unset multiplot");
  return {.svg = drawing.svg(), .share_within = share_within(components)};
}

}  // namespace fleetloc
