#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "cloud/laser_map/laser_map.hpp"

namespace fleetloc {

/// A k-d tree over points that outlive it. Every result is determined by the points and their
/// order.
class PointIndex {
 public:
  explicit PointIndex(std::span<const MapPoint> points);
  ~PointIndex();
  PointIndex(const PointIndex&) = delete;
  PointIndex& operator=(const PointIndex&) = delete;

  /// See LaserMap::nearest().
  [[nodiscard]] std::optional<LaserMap::Neighbour> nearest(const Eigen::Vector3d& p_map,
                                                           double radius_m) const;

  /// See LaserMap::surroundings().
  [[nodiscard]] LaserMap::Surroundings surroundings(const Eigen::Vector3d& p_map,
                                                    double radius_m) const;

  /// Indices of all points within `radius_m` (inclusive), increasing.
  [[nodiscard]] std::vector<std::size_t> within(const Eigen::Vector3d& p_map,
                                                double radius_m) const;

 private:
  struct Tree;
  std::unique_ptr<const Tree> tree_;
};

}  // namespace fleetloc
