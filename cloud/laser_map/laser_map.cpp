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
  const auto found = index_->nearest(p_map, radius_m);
  if (!found) return std::nullopt;
  return Neighbour{.index = found->index, .squared_distance = found->squared_distance};
}

}  // namespace fleetloc
