#pragma once

#include <cstddef>
#include <optional>
#include <unordered_map>

#include <Eigen/Core>

#include "cloud/laser_map/laser_map.hpp"
#include "shared/core/ids.hpp"

namespace fleetloc {

/// LaserMap::nearest() for landmarks that hardly move from one call to the next: the same results,
/// mostly without a search. A landmark that was next to one point, with all others at least
/// `clear_m` away, keeps that point as long as it has moved less than sets the two apart.
class NearestNeighborCache {
 public:
  /// The map must outlive it.
  explicit NearestNeighborCache(const LaserMap& map) : map_(&map) {}

  /// Of `landmark`, now at `p_map` [m].
  std::optional<LaserMap::Neighbour> nearest(LandmarkId landmark,
                                             const Eigen::Vector3d& p_map,
                                             double radius_m);

  /// Forgets the landmarks that `is_gone` is true for.
  template <typename Predicate>
  void forget(const Predicate& is_gone) {
    std::erase_if(memories_, [&](const auto& entry) { return is_gone(entry.first); });
  }

  [[nodiscard]] std::size_t searches() const { return searches_; }
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  struct Memory {
    Eigen::Vector3d p_map;
    LaserMap::Surroundings around;
  };

  const LaserMap* map_;
  std::unordered_map<LandmarkId, Memory> memories_;
  std::size_t searches_ = 0;
};

}  // namespace fleetloc
