#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "shared/core/ids.hpp"

namespace fleetloc {

class PointIndex;

/// A point of the laser map, with the surface around it.
struct MapPoint {
  Eigen::Vector3f p_map = Eigen::Vector3f::Zero();   ///< [m]
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< unit, of either sign; zero if not known
  /// 1 - sigma_0 / sigma_1 of the neighbourhood, whose standard deviations along the principal axes
  /// are sigma_0 <= sigma_1 <= sigma_2: 1 on a perfect plane, 0 on a line, in a volume, and where
  /// the neighbourhood is too sparse to tell.
  float planarity = 0.0F;
};

struct MapInfo {
  std::string frame;          ///< name of the frame of the points
  double resolution_m = 0.0;  ///< edge of the voxels, each of which holds one point at most
  Eigen::Vector3d min = Eigen::Vector3d::Zero();  ///< corner of the bounding box [m]
  Eigen::Vector3d max = Eigen::Vector3d::Zero();  ///< opposite corner [m]
  MapHash hash{};                                 ///< of the points, see map_hash.hpp
};

/// The map that robots are localized in. Immutable once built: all sessions share one, and every
/// thread may read it.
class LaserMap {
 public:
  /// Takes `info` as it is; build_map() and load_map() fill it in.
  LaserMap(std::vector<MapPoint> points, MapInfo info);
  LaserMap(LaserMap&& other) noexcept;
  LaserMap& operator=(LaserMap&& other) noexcept;
  LaserMap(const LaserMap&) = delete;
  LaserMap& operator=(const LaserMap&) = delete;
  ~LaserMap();

  [[nodiscard]] const MapInfo& info() const { return info_; }
  [[nodiscard]] const std::vector<MapPoint>& points() const { return points_; }
  [[nodiscard]] std::size_t size() const { return points_.size(); }
  [[nodiscard]] const MapPoint& point(std::size_t index) const { return points_[index]; }

  struct Neighbour {
    std::size_t index = 0;
    double squared_distance = 0.0;  ///< [m^2]
  };
  /// The point nearest to `p_map` [m]; of several at one distance that of the least index. Nothing
  /// if none is within `radius_m` (inclusive), or if `p_map` is not finite.
  [[nodiscard]] std::optional<Neighbour> nearest(const Eigen::Vector3d& p_map,
                                                 double radius_m) const;

  /// The nearest point, and a lower bound of the distance to all others.
  struct Surroundings {
    std::optional<Neighbour> nearest;  ///< see nearest()
    double clear_m = 0.0;              ///< no other point is nearer; at most the radius [m]
  };
  [[nodiscard]] Surroundings surroundings(const Eigen::Vector3d& p_map, double radius_m) const;

  /// Point `index` as nearest() would return it.
  [[nodiscard]] Neighbour neighbour(std::size_t index, const Eigen::Vector3d& p_map) const;

 private:
  std::vector<MapPoint> points_;
  MapInfo info_;
  std::unique_ptr<const PointIndex> index_;
};

}  // namespace fleetloc
