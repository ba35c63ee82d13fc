#include "deploy/evaluation/report/box_figure.hpp"

#include <algorithm>
#include <array>

#include "deploy/evaluation/report/drawing.hpp"
#include "shared/core/percentile.hpp"

namespace fleetloc {
namespace {

constexpr double kMin = 1e-4;  // smaller values are no longer told apart
constexpr std::array<const char*, 3> kColours{colour::kBlue, colour::kVermillion, colour::kGreen};

struct Range {
  double min = 0.0;
  double max = 0.0;
};

std::optional<Range> range_of(const BoxFigure& figure) {
  std::optional<Range> range;
  for (const BoxGroup& group : figure.groups) {
    for (const auto& box : group.boxes) {
      if (!box) continue;
      const double min = std::max(kMin, box->p5);
      const double max = std::max(kMin, box->max);
      range = range ? Range{std::min(range->min, min), std::max(range->max, max)} : Range{min, max};
    }
  }
  return range;
}

/// Boxes of one series: x, then the values that `candlesticks` takes, the median and the maximum.
std::vector<std::vector<double>> box_rows(const BoxFigure& figure,
                                          std::size_t series,
                                          double width) {
  std::vector<std::vector<double>> rows;
  const double offset =
      width * (static_cast<double>(series) - 0.5 * static_cast<double>(figure.series.size() - 1));
  for (std::size_t i = 0; i < figure.groups.size(); ++i) {
    const auto& boxes = figure.groups[i].boxes;
    if (series >= boxes.size() || !boxes[series]) continue;
    const Box& box = *boxes[series];
    std::vector<double> row{static_cast<double>(i) + offset};
    for (const double value : {box.q1, box.p5, box.p95, box.q3, box.median, box.max}) {
      row.push_back(std::max(kMin, value));
    }
    rows.push_back(row);
  }
  return rows;
}

/// Turned if they would not fit side by side.
std::string tics_of(const BoxFigure& figure, bool& turned) {
  constexpr std::size_t kFit = 44;  // letters
  std::string tics;
  std::size_t longest = 0;
  for (std::size_t i = 0; i < figure.groups.size(); ++i) {
    const std::string& label = figure.groups[i].label;
    longest = std::max(longest, label.size());
    tics +=
        (tics.empty() ? "" : ", ") + plot_string(label) + " " + plot_number(static_cast<double>(i));
  }
  turned = (longest + 1) * figure.groups.size() > kFit;
  return tics;
}

std::string plot_of(const std::string& name,
                    const char* colour,
                    const std::string& title,
                    double width) {
  const std::string line = std::string(" linecolor rgb '") + colour + "' ";
  return "$" + name + " using 1:2:3:4:5:(" + plot_number(0.8 * width) +
         ") with candlesticks fillstyle solid 0.3 border linewidth 1.3" + line + "title " +
         plot_string(title) + " whiskerbars 0.6, $" + name + " using 1:6:6:6:6:(" +
         plot_number(0.8 * width) + ") with candlesticks linewidth 2.6" + line + "notitle, $" +
         name + " using 1:7 with points pointtype 7 pointsize 0.3" + line + "notitle";
}

}  // namespace

std::optional<Box> box_of(const std::vector<double>& values) {
  if (values.empty()) return std::nullopt;
  const auto at = [&values](double share) { return *percentile(values, share); };
  return Box{.p5 = at(0.05),
             .q1 = at(0.25),
             .median = at(0.5),
             .q3 = at(0.75),
             .p95 = at(0.95),
             .max = at(1.0)};
}

std::string box_figure(const BoxFigure& figure) {
  const auto range = range_of(figure);
  if (!range) return "";
  constexpr int kHeight_px = 340;
  constexpr int kTurnedLabels_px = 60;
  bool turned = false;
  const std::string tics = tics_of(figure, turned);
  Drawing drawing(figure.id, figure.title, kHeight_px + (turned ? kTurnedLabels_px : 0));
  const double width = 0.8 / static_cast<double>(figure.series.size());
  const double min = rounded_down(0.9 * range->min);
  const double max = rounded_up(1.1 * std::max(range->max, 2.0 * min));
  drawing.command(
      "set logscale y\nset format y '%g'\nset grid noxtics\nset key samplen 1.2 font ',13' width "
      "-3");
  drawing.command("set yrange [" + plot_number(min) + ":" + plot_number(max) + "]");
  if (max < 1e3 * min) drawing.command("set ytics (" + log_tics(min, max) + ")");
  drawing.command(
      "set xrange [-0.6:" + plot_number(static_cast<double>(figure.groups.size()) - 0.4) + "]");
  drawing.command("set xtics " + std::string(turned ? "rotate by -40 " : "") + "(" + tics + ")");
  drawing.command("set xlabel " + plot_string(figure.x_label) + "\nset ylabel " +
                  plot_string(figure.y_label));
  std::string plot;
  for (std::size_t i = 0; i < figure.series.size(); ++i) {
    const auto rows = box_rows(figure, i, width);
    if (rows.empty()) continue;
    const std::string name = "series" + std::to_string(i);
    drawing.data(name, rows);
    plot += (plot.empty() ? "plot " : ", ") +
            plot_of(name, kColours.at(i % kColours.size()), figure.series[i], width);
  }
  drawing.command(plot);
  return drawing.svg();
}

}  // namespace fleetloc
