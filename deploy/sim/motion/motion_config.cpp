#include "deploy/sim/motion/motion_config.hpp"

#include <cmath>
#include <string>
#include <vector>

#include "shared/geometry/angle.hpp"

namespace fleetloc {
namespace {

double not_negative(ConfigReader& reader, const std::string& key) {
  const auto value = reader.get<double>(key);
  if (!(value >= 0.0 && std::isfinite(value))) {
    throw ConfigError(key + ": must not be negative");
  }
  return value;
}

std::vector<Eigen::Vector3d> read_waypoints(ConfigReader& reader) {
  std::vector<Eigen::Vector3d> waypoints;
  for (const auto& numbers : reader.get<std::vector<std::vector<double>>>("waypoints")) {
    const std::string name = "waypoints: the " + std::to_string(waypoints.size() + 1) + ". one";
    if (numbers.size() < 2 || numbers.size() > 3) throw ConfigError(name + " is no [x, y, z]");
    waypoints.emplace_back(numbers[0], numbers[1], numbers.size() == 3 ? numbers[2] : 0.0);
    if (!waypoints.back().allFinite()) throw ConfigError(name + " is not finite");
  }
  if (waypoints.size() < 2) throw ConfigError("waypoints: there must be two at least");
  return waypoints;
}

}  // namespace

MotionMagnitudes read_motion_limits(ConfigReader section) {
  return {.speed = section.positive("speed_m_s"),
          .acceleration = section.positive("acceleration_m_s2"),
          .turn_rate = kRadPerDeg * section.positive("turn_rate_deg_s"),
          .angular_acceleration = kRadPerDeg * section.positive("angular_acceleration_deg_s2")};
}

VibrationConfig read_vibration_config(ConfigReader section) {
  return {.height_m = not_negative(section, "height_m"),
          .pitch_rad = kRadPerDeg * not_negative(section, "pitch_deg"),
          .roll_rad = kRadPerDeg * not_negative(section, "roll_deg"),
          .frequency_hz = section.positive("frequency_hz"),
          .full_from_speed = section.positive("full_from_speed_m_s")};
}

RecordFitConfig read_record_fit_config(ConfigReader section, const MotionMagnitudes& limits) {
  return {.knot_interval_s = section.positive("knot_interval_s"),
          .position_cutoff_hz = section.positive("position_cutoff_hz"),
          .rotation_cutoff_hz = section.positive("rotation_cutoff_hz"),
          .limits = limits,
          .max_gap_s = section.positive("max_gap_s"),
          .max_rounds = section.integer("max_rounds", 1, 10'000)};
}

WaypointRoute read_route(ConfigReader reader) {
  WaypointRoute route;
  route.waypoints_m = read_waypoints(reader);
  route.speed = reader.positive("speed_m_s");
  route.rest_s = not_negative(reader, "rest_s");
  route.corner_radius_m = reader.positive("corner_radius_m");
  route.loop = reader.get<bool>("loop");
  route.laps = reader.integer("laps", 1, 1000);
  if (reader.has("reverse")) route.reverse = reader.get<bool>("reverse");
  reader.expect_fully_read();
  return route;
}

WaypointRoute read_route(const std::filesystem::path& file) {
  try {
    return read_route(ConfigReader::from_file(file));
  } catch (const ConfigError& error) {
    const std::string message = error.what();
    const bool named = message.starts_with(file.string());
    throw ConfigError(named ? message : file.string() + ": " + message);
  }
}

}  // namespace fleetloc
