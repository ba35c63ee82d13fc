#include <algorithm>

#include "deploy/evaluation/report/drawing.hpp"
#include "deploy/evaluation/report/figures.hpp"

namespace fleetloc {

std::string session_figure(const std::vector<SessionRow>& rows, const std::string& id) {
  constexpr std::size_t kMaxRows = 24;  // more are no picture any more; the table has them all
  constexpr double kHalf = 0.34;
  if (rows.empty()) return "";
  const std::size_t count = std::min(rows.size(), kMaxRows);
  Drawing drawing(id,
                  "time of an optimization in the cloud, median and 99th percentile",
                  100 + 30 * static_cast<int>(count));
  std::vector<std::vector<double>> p50;
  std::vector<std::vector<double>> p99;
  std::string tics;
  for (std::size_t i = 0; i < count; ++i) {
    const auto y = static_cast<double>(count - 1 - i);
    p50.push_back({0.0, y, 0.0, rows[i].p50_ms, y - kHalf, y + kHalf});
    p99.push_back({0.0, y, 0.0, rows[i].p99_ms, y - 0.6 * kHalf, y + 0.6 * kHalf});
    tics += (tics.empty() ? "" : ", ") + plot_string(rows[i].name) + " " + plot_number(y);
  }
  drawing.data("p50", p50);
  drawing.data("p99", p99);
  drawing.command("set yrange [-0.6:" + plot_number(static_cast<double>(count) - 0.4) + "]");
  drawing.command("set xrange [0:*]\nset xlabel 'optimization [ms]' offset 0,0.4");
  drawing.command("set grid noytics\nset ytics (" + tics + ")");
  drawing.command(
      std::string("plot $p99 with boxxyerror fillstyle solid 1 noborder linecolor rgb '") +
      colour::kSky +
      "' title '99th percentile', $p50 with boxxyerror fillstyle solid 1 "
      "noborder linecolor rgb '" +
      colour::kBlue + "' title 'median'");
  return drawing.svg();
}

}  // namespace fleetloc
