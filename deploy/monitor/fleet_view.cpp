#include "deploy/monitor/fleet_view.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace fleetloc {
namespace {

/// "-" for what is not known.
std::string number(const char* format, double value) {
  if (!std::isfinite(value)) return "-";
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

std::string known(const std::string& text) {
  return text.empty() ? "-" : text;
}

using Row = std::vector<std::string>;

Row row_of(const RobotView& robot) {
  return {robot.name,
          number("%.1f s", robot.time_s),
          robot.ended ? "ended" : known(robot.state),
          number("%.3f m", robot.error_m),
          number("%.3f m", robot.sigma_m),
          number("%.1f KB/s", robot.uplink_kb_s),
          number("%.1f KB/s", robot.downlink_kb_s),
          number("%.2f s", robot.round_trip_s)};
}

Row row_of(const LocalizerView& localizer) {
  const double percent = localizer.sessions.empty() ? std::nan("") : 100.0 * localizer.load;
  return {localizer.name,
          known(localizer.state),
          known(localizer.sessions),
          number("%.0f %%", percent),
          known(localizer.submaps),
          known(localizer.localized)};
}

std::string aligned(const std::vector<Row>& rows) {
  std::string text;
  for (const Row& row : rows) {
    for (std::size_t column = 0; column < row.size(); ++column) {
      std::size_t width = 0;
      for (const Row& other : rows) width = std::max(width, other[column].size());
      text += row[column];
      if (column + 1 < row.size()) text += std::string(width - row[column].size() + 2, ' ');
    }
    text += '\n';
  }
  return text;
}

}  // namespace

std::string table(const FleetView& fleet) {
  std::vector<Row> robots{
      {"robot", "time", "state", "error", "1 sigma", "up", "down", "round trip"}};
  for (const RobotView& robot : fleet.robots) robots.push_back(row_of(robot));
  std::vector<Row> localizers{{"localizer", "state", "robots", "load", "submaps", "localized"}};
  for (const LocalizerView& localizer : fleet.localizers) localizers.push_back(row_of(localizer));
  return aligned(robots) + (fleet.localizers.empty() ? "" : aligned(localizers));
}

std::string line(const FleetView& fleet) {
  std::string text;
  for (const RobotView& robot : fleet.robots) {
    const Row row = row_of(robot);
    if (!text.empty()) text += "; ";
    text += row[0] + " " + row[1] + " " + row[2] + ", error " + row[3] + ", sigma " + row[4] +
            ", up " + row[5] + ", down " + row[6] + ", round trip " + row[7];
  }
  for (const LocalizerView& localizer : fleet.localizers) {
    const Row row = row_of(localizer);
    if (!text.empty()) text += "; ";
    text += row[0] + ": " + row[1] + ", robots " + row[2] + ", load " + row[3] + ", localized " +
            row[5];
  }
  return text;
}

}  // namespace fleetloc
