#pragma once

#include <vector>

#include "cloud/laser_map/laser_map.hpp"
#include "cloud/localizer/map_match.hpp"

namespace fleetloc {

constexpr double kSnow = 0.4;  ///< depth [m]

/// A yard of 20 m x 20 m between walls of 3 m, on level ground; its middle is the map's origin.
LaserMap yard();

/// What a robot in the middle sees: 100 landmarks on the ground and 200 on the walls, with 2 cm
/// noise. Beside a cleared way, which has a share of those on the ground, there is snow.
std::vector<WindowLandmark> landmarks_of_yard(double cleared_share);

/// As a robot sees them that believes itself to be `t` further [m].
std::vector<WindowLandmark> moved(std::vector<WindowLandmark> landmarks, const Eigen::Vector3d& t);

}  // namespace fleetloc
