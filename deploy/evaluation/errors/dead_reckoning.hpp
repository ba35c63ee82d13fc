#pragma once

#include "shared/trajectory/trajectory.hpp"

namespace fleetloc {

/// The control "aligned once at the start": the odometry, put into the map by the first stamp that
/// both have, and dead-reckoned from there. T_map_body at every stamp that both have.
Trajectory aligned_once(const Trajectory& odometry, const Trajectory& localization);

}  // namespace fleetloc
