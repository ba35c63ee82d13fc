#pragma once

#include <cstdint>
#include <vector>

#include "cloud/laser_map/laser_map.hpp"
#include "cloud/locate/map_pyramid.hpp"
#include "shared/core/counter_random.hpp"

namespace fleetloc {

/// Walls of random places and headings on a level ground, as points every 0.25 m.
class StreetMap {
 public:
  explicit StreetMap(std::uint64_t seed,
                     int walls = 12,
                     double width_m = 40.0,
                     double depth_m = 30.0)
      : random_(seed, 1), width_m_(width_m), depth_m_(depth_m) {
    for (int i = 0; i < walls; ++i) add_wall(static_cast<std::uint64_t>(i));
    wall_points_ = points_.size();
    for (double x = 0.0; x <= width_m_; x += 0.25) {
      for (double y = 0.0; y <= depth_m_; y += 0.25) add({x, y, 0.0}, Eigen::Vector3f::UnitZ());
    }
  }

  [[nodiscard]] LaserMap map() const {
    MapInfo info{.frame = "map", .resolution_m = 0.25};
    info.min = info.max = points_.front().p_map.cast<double>();
    for (const MapPoint& point : points_) {
      info.min = info.min.cwiseMin(point.p_map.cast<double>());
      info.max = info.max.cwiseMax(point.p_map.cast<double>());
    }
    return {points_, info};
  }

  /// Some points of walls within `reach_m`, evenly drawn.
  [[nodiscard]] std::vector<Eigen::Vector3d> seen_from(const Eigen::Vector3d& p_map,
                                                       double reach_m,
                                                       std::size_t count) const {
    std::vector<Eigen::Vector3d> near;
    for (std::size_t i = 0; i < wall_points_; ++i) {
      const Eigen::Vector3d p = points_[i].p_map.cast<double>();
      if ((p - p_map).norm() < reach_m) near.push_back(p);
    }
    std::vector<Eigen::Vector3d> seen;
    for (std::size_t i = 0; i < count && !near.empty(); ++i) {
      const double share = random_.uniform(1000 + i);
      seen.push_back(near[static_cast<std::size_t>(share * static_cast<double>(near.size()))]);
    }
    return seen;
  }

 private:
  void add_wall(std::uint64_t i) {
    const Eigen::Vector3d from(
        width_m_ * random_.uniform(i, 0), depth_m_ * random_.uniform(i, 1), 0.0);
    const double heading = 2.0 * M_PI * random_.uniform(i, 2);
    const Eigen::Vector3d along(std::cos(heading), std::sin(heading), 0.0);
    const Eigen::Vector3f normal(static_cast<float>(-along.y()), static_cast<float>(along.x()), 0);
    const double length = 2.0 + 8.0 * random_.uniform(i, 3);
    const double height = 2.0 + 2.0 * random_.uniform(i, 4);
    for (double s = 0.0; s <= length; s += 0.25) {
      for (double z = 0.0; z <= height; z += 0.25) {
        const Eigen::Vector3d p = from + s * along + z * Eigen::Vector3d::UnitZ();
        if (p.x() >= 0.0 && p.x() <= width_m_ && p.y() >= 0.0 && p.y() <= depth_m_) add(p, normal);
      }
    }
  }

  void add(const Eigen::Vector3d& p_map, const Eigen::Vector3f& normal) {
    points_.push_back({.p_map = p_map.cast<float>(), .normal = normal, .planarity = 1.0F});
  }

  CounterRandom random_;
  double width_m_;
  double depth_m_;
  std::vector<MapPoint> points_;
  std::size_t wall_points_ = 0;
};

inline MapPyramid::Config pyramid_config() {
  return {.cell_m = 0.5, .levels = 5, .level_from = 0.7};
}

}  // namespace fleetloc
