#include <algorithm>
#include <array>
#include <cmath>

#include "deploy/evaluation/report/drawing.hpp"
#include "deploy/evaluation/report/figures.hpp"

namespace fleetloc {
namespace {

using Rows = std::vector<std::vector<double>>;

constexpr std::size_t kMaxLinePoints = 600;  // of a line
constexpr double kMaxIntervals = 300.0;      // that bytes are summed over
constexpr std::size_t kMaxMarks = 400;       // of answers in one row

double length_s(const RunData& run) {
  return run.frames.empty() ? 0.0 : run.seconds(run.frames.back().stamp);
}

std::string time_axis(double length) {
  return "set xrange [0:" + plot_number(std::max(length, 1.0)) +
         "]\nset xlabel 'time [s]' offset 0,0.4";
}

/// Growth of a counter per second, over equal intervals; each row begins one.
Rows rates(const RunData& run, double FrameDiagnostics::*counter, double interval_s) {
  Rows rows;
  double begin_s = 0.0;
  double count = run.frames.front().*counter;
  for (const FrameDiagnostics& frame : run.frames) {
    const double time = run.seconds(frame.stamp);
    const bool is_last = &frame == &run.frames.back();
    if (time - begin_s < interval_s && !(is_last && time > begin_s)) continue;
    const double rate = (frame.*counter - count) / (time - begin_s);
    rows.push_back({begin_s, 1e-3 * rate});
    if (is_last) rows.push_back({time, 1e-3 * rate});
    begin_s = time;
    count = frame.*counter;
  }
  return rows;
}

/// From zero to a little above the largest value, and to `least` at least.
std::string range_from_zero(const Rows& rows, double min) {
  double max = min;
  for (const auto& row : rows) max = std::max(max, 1.1 * row[1]);
  return "set yrange [0:" + plot_number(max) + "]\nset ytics " + plot_number(tic_step(max, 5)) +
         "\n";
}

/// A line that keeps its value up to the next frame; only where it changes.
Rows changes(const Series& series) {
  Rows rows;
  for (const auto& [time, value] : series) {
    const bool changed = rows.empty() || rows.back()[1] != value;
    if (changed || time == series.back().first) rows.push_back({time, value});
  }
  return rows;
}

/// From the middle of one row of the figure to that of the next.
struct Lane {
  const char* state;
  const char* label;
  const char* colour;
};

constexpr std::array<Lane, 5> kLanes{{{"initializing", "initializing", colour::kGrey},
                                      {"searching", "searching", colour::kSky},
                                      {"lost", "lost", colour::kVermillion},
                                      {"dead_reckoning", "dead reckoning", colour::kOrange},
                                      {"localized", "localized", colour::kBlue}}};

/// Boxes `x y x_low x_high y_low y_high` of the times in one state.
Rows boxes(const RunData& run, const Lane& lane, double y) {
  constexpr double kHalf = 0.36;
  Rows rows;
  for (std::size_t begin = 0; begin < run.frames.size();) {
    std::size_t end = begin + 1;
    while (end < run.frames.size() && run.frames[end].state == run.frames[begin].state) ++end;
    if (run.frames[begin].state == lane.state) {
      const double from = run.seconds(run.frames[begin].stamp);
      const double to = run.seconds(run.frames[std::min(end, run.frames.size() - 1)].stamp);
      rows.push_back({from, y, from, to, y - kHalf, y + kHalf});
    }
    begin = end;
  }
  return rows;
}

/// Upright strokes, one for all answers that would overlap.
Rows strokes(const RunData& run, bool applied, double y) {
  constexpr double kHalf = 0.3;
  const double min_s = length_s(run) / static_cast<double>(kMaxMarks);
  Rows rows;
  double before = -1e9;
  for (const AnswerMark& answer : run.answers) {
    const double time = run.seconds(answer.arrival);
    if (answer.applied != applied || time - before < min_s) continue;
    rows.push_back({time, y - kHalf});
    rows.push_back({time, y + kHalf});
    rows.emplace_back();
    before = time;
  }
  return rows;
}

}  // namespace

std::string bytes_figure(const RunData& run, const std::string& id) {
  const double length = length_s(run);
  if (length <= 0.0 || run.frames.back().uplink_bytes + run.frames.back().downlink_bytes <= 0.0) {
    return "";
  }
  const double interval_s = std::max(1.0, std::ceil(length / kMaxIntervals));
  Drawing drawing(id + "bytes", "payload per second, up and down", 280);
  const Rows up = rates(run, &FrameDiagnostics::uplink_bytes, interval_s);
  const Rows down = rates(run, &FrameDiagnostics::downlink_bytes, interval_s);
  Rows both = up;
  both.insert(both.end(), down.begin(), down.end());
  drawing.data("up", up);
  drawing.data("down", down);
  drawing.command(time_axis(length) + "\nset ylabel 'kB/s' offset 0.5,0");
  drawing.command(range_from_zero(both, 1e-3));
  drawing.command(std::string("plot $up with steps linewidth 1.8 linecolor rgb '") + colour::kBlue +
                  "' title 'robot to cloud', $down with steps linewidth 1.8 dashtype 2 linecolor "
                  "rgb '" +
                  colour::kVermillion + "' title 'cloud to robot'");
  return drawing.svg();
}

std::string link_figure(const RunData& run, const std::string& id) {
  Series round_trip;
  Series loss;
  for (const FrameDiagnostics& frame : run.frames) {
    if (!frame.round_trip_s) continue;
    const double time = run.seconds(frame.stamp);
    round_trip.emplace_back(time, *frame.round_trip_s);
    loss.emplace_back(time, 100.0 * frame.loss);
  }
  if (round_trip.empty()) return "";
  Drawing drawing(id + "link", "round trip and loss over time", 380);
  const auto panel = [&](const char* name, const Rows& rows, double min, const char* style) {
    drawing.data(name, rows);
    drawing.command(range_from_zero(rows, min) + "plot $" + name + " with steps linewidth 1.6 " +
                    style);
  };
  drawing.command(time_axis(length_s(run)) + "\nset xlabel ''\nset format x ''");
  drawing.command(
      "set multiplot layout 2,1 margins screen 0.18,0.97,0.14,0.96 spacing screen 0.05\n"
      "set ylabel 'round trip [s]' offset 0.5,0");
  panel("round_trip",
        changes(thinned(round_trip, kMaxLinePoints)),
        1e-3,
        "linecolor rgb '#0072B2' notitle");
  drawing.command("set format x '%g'\nset xlabel 'time [s]' offset 0,0.4");
  drawing.command("set ylabel 'loss [%]' offset 0.5,0");
  panel("loss", changes(thinned(loss, kMaxLinePoints)), 5.0, "linecolor rgb '#D55E00' notitle");
  drawing.command("unset multiplot");
  return drawing.svg();
}

std::string states_figure(const RunData& run, const std::string& id) {
  if (run.frames.empty()) return "";
  Drawing drawing(id + "states", "states and answers over time", 260);
  std::string plot;
  std::string tics = "'not applied' 0, 'answers applied' 1";
  const auto add = [&](const std::string& name, const Rows& rows, const std::string& style) {
    if (rows.empty()) return;
    drawing.data(name, rows);
    plot += (plot.empty() ? "plot $" : ", $") + name + " " + style + " notitle";
  };
  add("missed",
      strokes(run, false, 0.0),
      std::string("with lines linewidth 1.2 linecolor rgb '") + colour::kPurple + "'");
  add("applied",
      strokes(run, true, 1.0),
      std::string("with lines linewidth 1.2 linecolor rgb '") + colour::kGreen + "'");
  for (std::size_t i = 0; i < kLanes.size(); ++i) {
    const Lane& lane = kLanes[i];
    const double y = 2.0 + static_cast<double>(i);
    tics += std::string(", '") + lane.label + "' " + plot_number(y);
    add(lane.state,
        boxes(run, lane, y),
        std::string("with boxxyerror fillstyle solid noborder linecolor rgb '") + lane.colour +
            "'");
  }
  drawing.command(time_axis(length_s(run)) + "\nset yrange [-0.6:5.6]\nset ytics (" + tics + ")");
  drawing.command("set lmargin at screen 0.27\nset grid noytics");
  drawing.command(plot.empty() ? "plot NaN notitle" : plot);
  return drawing.svg();
}

}  // namespace fleetloc
