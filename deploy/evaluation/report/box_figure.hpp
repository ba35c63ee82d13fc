#pragma once

#include <optional>
#include <string>
#include <vector>

namespace fleetloc {

/// Quantiles that a box shows.
struct Box {
  double p5 = 0.0;
  double q1 = 0.0;
  double median = 0.0;
  double q3 = 0.0;
  double p95 = 0.0;
  double max = 0.0;
};

/// Nothing for no values.
std::optional<Box> box_of(const std::vector<double>& values);

/// A position on the horizontal axis, with a box of each series or none.
struct BoxGroup {
  std::string label;
  std::vector<std::optional<Box>> boxes;
};

struct BoxFigure {
  std::string id;
  std::string title;  ///< for screen readers
  std::string x_label;
  std::string y_label;
  std::vector<std::string> series;  ///< names, at most three
  std::vector<BoxGroup> groups;
};

/// Boxes from the lower to the upper quartile with a stroke at the median, whiskers from 5 to 95 %
/// and a dot at the maximum; the scale is logarithmic. An <svg> element, empty if there is no box.
/// Throws std::runtime_error, see gnuplot_output().
std::string box_figure(const BoxFigure& figure);

}  // namespace fleetloc
