#include "cloud/laser_map/laser_map.hpp"

#include <utility>

#include "cloud/laser_map/point_index.hpp"

namespace fleetloc {

LaserMap::LaserMap(std::vector<MapPoint> points, MapInfo info)
    : points_(std::move(points)),
      info_(std::move(info)),
      index_(std::make_unique<const PointIndex>(points_)) {}

// Moving a vector leaves its elements where they are, so the index stays valid.
LaserMap::LaserMap(LaserMap&& other) noexcept = default;
LaserMap& LaserMap::operator=(LaserMap&& other) noexcept = default;
LaserMap::~LaserMap() = default;

std::optional<LaserMap::Neighbour> LaserMap::nearest(const Eigen::Vector3d& p_map,
                                                     double radius_m) const {
  return index_->nearest(p_map, radius_m);
}

LaserMap::Surroundings LaserMap::surroundings(const Eigen::Vector3d& p_map, double radius_m) const {
  return index_->surroundings(p_map, radius_m);
}

LaserMap::Neighbour LaserMap::neighbour(std::size_t index, const Eigen::Vector3d& p_map) const {
  const Eigen::Vector3d d = p_map - points_[index].p_map.cast<double>();
  return {.index = index,
          .squared_distance = d.x() * d.x() + d.y() * d.y() + d.z() * d.z()};  // in this order
}

}  // namespace fleetloc
