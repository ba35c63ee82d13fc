#include "cloud/localizer/nearest_neighbor_cache.hpp"

#include <cmath>

namespace fleetloc {
namespace {

constexpr double kRounding_m = 1e-6;  // far above rounding errors of distances within a map

}  // namespace

std::optional<LaserMap::Neighbour> NearestNeighborCache::nearest(LandmarkId landmark,
                                                                 const Eigen::Vector3d& p_map,
                                                                 double radius_m) {
  const auto found = entries_.find(landmark);
  if (found != entries_.end()) {
    const auto& [p_then, around] = found->second;
    // No other point is nearer than this, by the triangle inequality.
    const double others_m = around.clear_m - (p_map - p_then).norm() - kRounding_m;
    if (radius_m < others_m && !around.nearest) return std::nullopt;
    if (around.nearest) {
      const LaserMap::Neighbour same = map_->neighbour(around.nearest->index, p_map);
      const bool is_within = same.squared_distance <= radius_m * radius_m;
      if (std::sqrt(same.squared_distance) < others_m && is_within) return same;
      if (radius_m < others_m && !is_within) return std::nullopt;
    }
  }
  ++searches_;
  const LaserMap::Surroundings around = map_->surroundings(p_map, radius_m);
  entries_.insert_or_assign(landmark, Entry{p_map, around});
  return around.nearest;
}

std::size_t NearestNeighborCache::memory_bytes() const {
  return entries_.size() * (sizeof(Entry) + sizeof(LandmarkId) + 2 * sizeof(void*));
}

}  // namespace fleetloc
