#include <algorithm>
#include <cmath>

#include "deploy/evaluation/report/drawing.hpp"
#include "deploy/evaluation/report/figures.hpp"
#include "deploy/evaluation/report/map_layer.hpp"

namespace fleetloc {
namespace {

// Pixels of the canvas around the part that shows the map.
constexpr int kLeft = 58;
constexpr int kRight = 14;
constexpr int kTop = 34;
constexpr int kBottom = 60;
constexpr int kColourBar = 52;
constexpr int kPlotWidth = kWidth_px - kLeft - kRight;
constexpr int kMinHeight = 200;
constexpr int kMaxHeight = 520;
constexpr std::size_t kMaxTrajectoryPoints = 900;  // of a trajectory

struct TrackPoint {
  Timestamp stamp;
  Eigen::Vector2d p_map;
  double error_m = 0.0;
};
using Track = std::vector<TrackPoint>;

Track estimate_of(std::span<const PosePair> pairs) {
  Track track;
  for (const PosePair& pair : pairs) {
    track.push_back({pair.stamp, pair.T_estimate_body.p.head<2>(), position_error(pair).norm()});
  }
  return track;
}

Track truth_of(std::span<const PosePair> pairs) {
  Track track;
  for (const PosePair& pair : pairs) track.push_back({pair.stamp, pair.T_truth_body.p.head<2>()});
  return track;
}

Track track_of(const Trajectory& trajectory) {
  Track track;
  for (const StampedPose& pose : trajectory) {
    track.push_back({pose.stamp, pose.T_ref_body.p.head<2>()});
  }
  return track;
}

/// A view of at least 2 m that holds all tracks, and the map around them.
View view_of(std::span<const Track> tracks, std::span<const Eigen::Vector3f> map) {
  constexpr double kMapShare = 0.6;  // of the tracks' extent that the map is shown beyond them
  Eigen::AlignedBox2d box;
  for (const Track& track : tracks) {
    for (const TrackPoint& point : track) box.extend(point.p_map);
  }
  const double extent = std::max(box.sizes().maxCoeff(), 1.0);
  Eigen::AlignedBox2d around;
  for (const Eigen::Vector3f& point : map) {
    if (point.allFinite()) around.extend(point.head<2>().cast<double>());
  }
  const Eigen::Vector2d reach = Eigen::Vector2d::Constant(kMapShare * extent);
  around = around.intersection(Eigen::AlignedBox2d(box.min() - reach, box.max() + reach));
  if (!around.isEmpty()) box.extend(around);
  const Eigen::Vector2d size = (1.08 * box.sizes()).cwiseMax(2.0);
  View view{.width_px = kPlotWidth};
  view.metres_per_px = std::max(size.x() / kPlotWidth, size.y() / kMaxHeight);
  view.height_px = std::max(kMinHeight, static_cast<int>(std::ceil(size.y() / view.metres_per_px)));
  view.corner_m = box.center() - 0.5 * view.size_m();
  return view;
}

/// Thinned, with an empty row where the line is interrupted.
std::vector<std::vector<double>> track_rows(const Track& track) {
  const std::size_t step = track.size() / kMaxTrajectoryPoints + 1;
  std::vector<std::vector<double>> rows;
  for (std::size_t i = 0; i < track.size(); ++i) {
    const TrackPoint& point = track[i];
    const bool gap = i > 0 && to_seconds(point.stamp - track[i - 1].stamp) > kLongestGap_s;
    if (gap) rows.emplace_back();
    if (gap || i % step == 0 || i + 1 == track.size()) {
      rows.push_back({point.p_map.x(), point.p_map.y(), std::max(point.error_m, 1e-6)});
    }
  }
  return rows;
}

std::string screen(double px, double whole_px) {
  return plot_number(px / whole_px);
}

/// Axes and map; what is plotted over it follows after a comma, or is what comes first.
class MapDrawing {
 public:
  MapDrawing(const std::string& id,
             const std::string& title,
             const View& view,
             std::span<const Eigen::Vector3f> map,
             int below_px)
      : height_px_(kTop + view.height_px + kBottom + below_px), drawing_(id, title, height_px_) {
    set_axes(view, below_px);
    const MapLayer layer = map_layer(map, view);
    add_layer("light", layer.light, layer.cell_px, "#e9e9e9");
    add_layer("dark", layer.dark, layer.cell_px, "#bcbcbc");
  }

  [[nodiscard]] int height_px() const { return height_px_; }
  Drawing& drawing() { return drawing_; }

  void plot(const std::string& what) { plots_ += (plots_.empty() ? "plot " : ", ") + what; }

  /// A track without colours.
  void plot_track(const std::string& name, const Track& track, const std::string& style) {
    if (track.empty()) return;
    drawing_.data(name, track_rows(track));
    plot("$" + name + " using 1:2 with lines " + style);
  }

  void plot_start(const Track& track) {
    drawing_.data("start", {{track.front().p_map.x(), track.front().p_map.y()}});
    plot(std::string("$start with points pointtype 6 pointsize 1.3 linewidth 2 linecolor rgb '") +
         colour::kVermillion + "' title 'start'");
  }

  std::string svg() {
    drawing_.command(plots_);
    return drawing_.svg();
  }

 private:
  void set_axes(const View& view, int below_px) {
    const double height = height_px_;
    const Eigen::Vector2d size = view.size_m();
    const Eigen::Vector2d end = view.corner_m + size;
    const auto range = [](double from, double to) {
      return "[" + plot_number(from) + ":" + plot_number(to) + "]";
    };
    drawing_.command("set lmargin at screen " + screen(kLeft, kWidth_px));
    drawing_.command("set rmargin at screen " + screen(kWidth_px - kRight, kWidth_px));
    drawing_.command("set tmargin at screen " + screen(height - kTop, height));
    drawing_.command("set bmargin at screen " + screen(kBottom + below_px, height));
    drawing_.command("set xrange " + range(view.corner_m.x(), end.x()));
    drawing_.command("set yrange " + range(view.corner_m.y(), end.y()));
    const std::string step = plot_number(tic_step(std::max(size.x(), size.y()), 7));
    drawing_.command("set xtics " + step + "\nset ytics " + step);
    drawing_.command("set xlabel 'x [m]' offset 0,0.4\nset ylabel 'y [m]' offset 1,0");
  }

  void add_layer(const std::string& name,
                 const std::vector<std::vector<double>>& runs,
                 double cell_px,
                 const std::string& colour) {
    if (runs.empty()) return;
    drawing_.data(name, runs);
    plot("$" + name + " using 1:2 with lines linewidth " + plot_number(cell_px + 0.1) +
         " linecolor rgb '" + colour + "' notitle");
  }

  int height_px_;
  Drawing drawing_;
  std::string plots_;
};

struct ColourRange {
  double min_m;
  double max_m;
};

/// From what is good for the localized pose to the worst of all.
ColourRange colour_range(std::span<const Track> tracks) {
  double min = 1e9;
  double max = 0.0;
  for (const Track& track : tracks) {
    std::vector<double> values;
    for (const TrackPoint& point : track) values.push_back(point.error_m);
    if (values.empty()) continue;
    std::ranges::sort(values);
    min = std::min(min, values[values.size() / 10]);
    max = std::max(max, values.back());
  }
  min = rounded_down(std::max(min, 1e-3));
  max = rounded_up(std::max(max, min));
  return {.min_m = min, .max_m = std::max(max, 10.0 * min)};
}

void set_colour_bar(Drawing& drawing, const ColourRange& range, int height_px) {
  const double height = height_px;
  drawing.command("set logscale cb");
  drawing.command("set cbrange [" + plot_number(range.min_m) + ":" + plot_number(range.max_m) +
                  "]");
  drawing.command("set colorbox horizontal user origin " + screen(kLeft, kWidth_px) + "," +
                  screen(42, height) + " size " + screen(kPlotWidth, kWidth_px) + "," +
                  screen(11, height) + "");
  drawing.command("set cbtics scale 0.4 offset 0,0.3 (" + log_tics(range.min_m, range.max_m) + ")");
  drawing.command("set cblabel 'error of position [m]' offset 0,0.5");
}

/// What the coloured figures of a run have in common.
struct Scene {
  View view;
  ColourRange range;
  std::span<const Eigen::Vector3f> map;
};

std::string coloured(const std::string& id,
                     const std::string& title,
                     std::span<const PosePair> pairs,
                     const Scene& scene) {
  if (pairs.empty()) return "";
  const Track estimate = estimate_of(pairs);
  MapDrawing figure(id, title, scene.view, scene.map, kColourBar);
  set_colour_bar(figure.drawing(), scene.range, figure.height_px());
  figure.plot_track("truth",
                    truth_of(pairs),
                    "linewidth 1.2 dashtype 2 linecolor rgb 'black' title 'ground truth'");
  figure.drawing().data("estimate", track_rows(estimate));
  figure.plot("$estimate using 1:2:3 with lines linewidth 3.5 linecolor palette notitle");
  figure.plot_start(estimate);
  return figure.svg();
}

}  // namespace

TrajectoryFigures trajectory_figures(const RunErrors& errors,
                                     std::span<const Eigen::Vector3f> map,
                                     const std::string& id) {
  if (errors.odometry.empty()) return {};
  const std::vector<Track> tracks{estimate_of(errors.localized),
                                  estimate_of(errors.aligned_once),
                                  estimate_of(errors.odometry),
                                  truth_of(errors.odometry)};
  const Scene scene{
      .view = view_of(tracks, map), .range = colour_range(std::span(tracks).first(3)), .map = map};
  return {
      .localized = coloured(id + "localized", "localized, from above", errors.localized, scene),
      .aligned_once = coloured(id + "once", "aligned once, from above", errors.aligned_once, scene),
      .odometry = coloured(id + "odometry", "odometry alone, from above", errors.odometry, scene)};
}

std::string trajectory_figure(const RunData& run,
                              std::span<const Eigen::Vector3f> map,
                              const std::string& id) {
  const std::vector<Track> tracks{track_of(run.localized), track_of(run.aligned_once)};
  if (tracks[0].empty()) return "";
  MapDrawing figure(
      id + "localized", "localized and aligned once, from above", view_of(tracks, map), map, 0);
  const auto style = [](const char* colour, const char* rest) {
    return std::string("linewidth 2 linecolor rgb '") + colour + "' " + rest;
  };
  figure.plot_track("localized", tracks[0], style(colour::kBlue, "title 'localized'"));
  figure.plot_track("once", tracks[1], style(colour::kOrange, "dashtype 2 title 'aligned once'"));
  figure.plot_start(tracks[0]);
  return figure.svg();
}

}  // namespace fleetloc
