#pragma once

#include <cstddef>
#include <optional>
#include <unordered_map>

#include <Eigen/Core>

#include "cloud/laser_map/laser_map.hpp"
#include "shared/core/ids.hpp"

namespace fleetloc {

/// LaserMap::nearest() for landmarks that hardly move from one call to the next: the same results,
/// mostly without a search. A landmark keeps its nearest point until it has moved so far that, by
/// the triangle inequality, another one may be nearer.
class NearestNeighborCache {
 public:
  /// The map must outlive it.
  explicit NearestNeighborCache(const LaserMap& map) : map_(&map) {}

  /// LaserMap::nearest() for `landmark`, which is at `p_map` [m] now.
  std::optional<LaserMap::Neighbour> nearest(LandmarkId landmark,
                                             const Eigen::Vector3d& p_map,
                                             double radius_m);

  /// Removes the landmarks for which `is_gone` is true.
  template <typename Predicate>
  void forget(const Predicate& is_gone) {
    std::erase_if(entries_, [&](const auto& entry) { return is_gone(entry.first); });
  }

  [[nodiscard]] std::size_t searches() const { return searches_; }
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  struct Entry {
    Eigen::Vector3d p_map;
    LaserMap::Surroundings around;
  };

  const LaserMap* map_;
  std::unordered_map<LandmarkId, Entry> entries_;
  std::size_t searches_ = 0;
};

}  // namespace fleetloc
