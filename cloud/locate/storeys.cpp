#include "cloud/locate/storeys.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace fleetloc {
namespace {

constexpr double kLowest_m = 2.0;  // above the ground
constexpr double kStep_m = 0.4;
constexpr double kRadius_m = 0.3;
constexpr double kLevelFrom = 0.9;    // vertical part of a unit normal
constexpr double kThickness_m = 1.0;  // of a floor with the ceiling below it
constexpr double kBeside_m = 1.0;     // where the map has a hole, its surface may be seen beside

/// Level surfaces along a vertical line, in any order.
void add_levels_along(const LaserMap& map,
                      const Eigen::Vector2d& p_map,
                      double from_m,
                      std::vector<double>& levels) {
  const double top_m = map.info().max.z() + kStep_m;
  for (double z = from_m; z < top_m; z += kStep_m) {
    const auto near = map.nearest({p_map.x(), p_map.y(), z}, kRadius_m);
    if (!near) continue;
    const MapPoint& point = map.point(near->index);
    if (std::abs(static_cast<double>(point.normal.z())) > kLevelFrom) {
      levels.push_back(static_cast<double>(point.p_map.z()));
    }
  }
}

}  // namespace

std::vector<double> storeys_above(const LaserMap& map,
                                  const Eigen::Vector2d& p_map,
                                  double ground_m) {
  const std::array<Eigen::Vector2d, 5> lines{Eigen::Vector2d(0.0, 0.0),
                                             Eigen::Vector2d(kBeside_m, 0.0),
                                             Eigen::Vector2d(-kBeside_m, 0.0),
                                             Eigen::Vector2d(0.0, kBeside_m),
                                             Eigen::Vector2d(0.0, -kBeside_m)};
  std::vector<double> levels;
  for (const Eigen::Vector2d& beside : lines) {
    add_levels_along(map, p_map + beside, ground_m + kLowest_m, levels);
  }
  std::ranges::sort(levels);
  std::vector<double> storeys;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const bool is_top = i + 1 == levels.size() || levels[i + 1] - levels[i] > kThickness_m;
    if (is_top) storeys.push_back(levels[i]);
  }
  return storeys;
}

}  // namespace fleetloc
