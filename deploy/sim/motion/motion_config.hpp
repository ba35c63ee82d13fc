#pragma once

#include <filesystem>

#include "deploy/sim/motion/recorded_motion.hpp"
#include "deploy/sim/motion/vibration.hpp"
#include "deploy/sim/motion/waypoint_motion.hpp"
#include "shared/config/config_reader.hpp"

namespace fleetloc {

/// Limits and disturbances of the motion; each throws ConfigError.
MotionMagnitudes read_motion_limits(ConfigReader section);
VibrationConfig read_vibration_config(ConfigReader section);
/// Its limits are those of read_motion_limits().
RecordFitConfig read_record_fit_config(ConfigReader section, const MotionMagnitudes& limits);

/// A route file (deploy/worlds/*.yaml): speed_m_s, rest_s, corner_radius_m, loop, laps,
/// reverse (may be left out) and waypoints, a list of [x, y] or [x, y, z] of the body in map (z
/// else 0). Throws ConfigError.
WaypointRoute read_route(const std::filesystem::path& file);
WaypointRoute read_route(ConfigReader reader);

}  // namespace fleetloc
