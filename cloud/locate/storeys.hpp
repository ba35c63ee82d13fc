#pragma once

#include <vector>

#include <Eigen/Core>

#include "cloud/laser_map/laser_map.hpp"

namespace fleetloc {

/// Heights of the level, planar surfaces above a place on which a robot may stand as well: the
/// storeys of a building. Ceilings and roofs are among them; what is less than 2 m or more than 60
/// m above the ground is not.
/// @param p_map     of the robot [m]
/// @param ground_m  the lowest one there, see GroundHeights
/// @return [m], increasing
std::vector<double> storeys_above(const LaserMap& map,
                                  const Eigen::Vector2d& p_map,
                                  double ground_m);

}  // namespace fleetloc
