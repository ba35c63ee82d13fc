#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "cloud/laser_map/laser_map.hpp"

namespace fleetloc {

/// Height of the ground of a map, over cells of some metres: that of the lowest level surface in a
/// cell and those around it. Where there is none, that of the nearest cell which has one.
class GroundHeights {
 public:
  /// @param level_from  vertical part of a unit normal; above it a surface is level
  GroundHeights(const LaserMap& map, double level_from);
  /// Of cells from the corner `min_map` [m] on, x fastest.
  /// @param heights  [m], as heights() has returned them: width x depth, both from 1
  GroundHeights(const Eigen::Vector2d& min_map, int width, int depth, std::vector<float> heights);

  /// [m]; beyond the map that at its edge, zero in a map without level surfaces.
  [[nodiscard]] double at(double x_m, double y_m) const;

  struct Range {
    double lowest_m = 0.0;
    double highest_m = 0.0;
  };
  /// Between two corners [m].
  [[nodiscard]] Range range(const Eigen::Vector2d& min_map, const Eigen::Vector2d& max_map) const;

  [[nodiscard]] const Eigen::Vector2d& min_map() const { return min_map_; }
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int depth() const { return depth_; }
  [[nodiscard]] const std::vector<float>& heights() const { return heights_; }

  [[nodiscard]] std::size_t bytes() const { return heights_.size() * sizeof(float); }

 private:
  [[nodiscard]] std::size_t index(double x_m, double y_m) const;
  void widen_lowest();
  void fill_gaps();

  Eigen::Vector2d min_map_ = Eigen::Vector2d::Zero();
  int width_ = 1;
  int depth_ = 1;
  std::vector<float> heights_;
};

}  // namespace fleetloc
