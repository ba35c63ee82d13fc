#include "cloud/locate/storeys.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace fleetloc {
namespace {

constexpr double kLowest_m = 2.0;  // above the ground
constexpr double kHighest_m = 60.0;
constexpr double kStep_m = 0.4;
constexpr double kRadius_m = 0.3;
constexpr double kLevelFrom = 0.9;    // vertical part of a unit normal
constexpr float kPlanarFrom = 0.6F;   // leaves are level by chance
constexpr double kThickness_m = 1.0;  // of a floor with the ceiling below it
constexpr double kBeside_m = 1.0;     // where the map has a hole, its surface may be seen beside

/// Heights of level surfaces along a vertical line, increasing.
std::vector<double> levels_along(const LaserMap& map,
                                 const Eigen::Vector2d& p_map,
                                 double ground_m) {
  std::vector<double> levels;
  const double top_m = std::min(map.info().max.z(), ground_m + kHighest_m) + kStep_m;
  for (double z = ground_m + kLowest_m + kRadius_m; z < top_m; z += kStep_m) {
    const auto near = map.nearest({p_map.x(), p_map.y(), z}, kRadius_m);
    if (!near) continue;
    const MapPoint& point = map.point(near->index);
    const bool is_level = std::abs(static_cast<double>(point.normal.z())) > kLevelFrom;
    if (is_level && point.planarity >= kPlanarFrom) {
      levels.push_back(static_cast<double>(point.p_map.z()));
    }
  }
  std::ranges::sort(levels);
  return levels;
}

}  // namespace

std::vector<double> storeys_above(const LaserMap& map,
                                  const Eigen::Vector2d& p_map,
                                  double ground_m) {
  std::vector<double> levels = levels_along(map, p_map, ground_m);
  const std::array<Eigen::Vector2d, 4> sides{Eigen::Vector2d(kBeside_m, 0.0),
                                             Eigen::Vector2d(-kBeside_m, 0.0),
                                             Eigen::Vector2d(0.0, kBeside_m),
                                             Eigen::Vector2d(0.0, -kBeside_m)};
  for (std::size_t i = 0; i < sides.size() && levels.empty(); ++i) {
    levels = levels_along(map, p_map + sides[i], ground_m);
  }
  std::vector<double> storeys;
  double bottom_m = 0.0;  // of the latest one
  for (const double level_m : levels) {
    if (!storeys.empty() && level_m - bottom_m <= kThickness_m) {
      storeys.back() = level_m;
    } else {
      storeys.push_back(level_m);
      bottom_m = level_m;
    }
  }
  return storeys;
}

}  // namespace fleetloc
