#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "cloud/laser_map/laser_map.hpp"
#include "cloud/locate/cell_grid.hpp"
#include "cloud/locate/ground_heights.hpp"

namespace fleetloc {

/// How well a landmark in a cell of the map is explained by a surface, and bounds of it over ever
/// larger windows of columns. Cell (x, y, z) spans [x, x + 1) * cell_m along the axes of the map,
/// and so on; its height is that above the ground, so that a robot that knows how high its camera
/// is knows z anywhere. The windows are those of Hess et al., "Real-time loop closure in 2D LIDAR
/// SLAM" (ICRA 2016): as fine as the cells at each level, so that no bound is looser than its
/// window.
class MapPyramid {
 public:
  struct Config {
    double cell_m;      ///< edge of the cells
    int levels;         ///< windows of level k have 2^k cells an edge
    double level_from;  ///< vertical part of a unit normal; above it a surface is level
  };
  static constexpr int kFull = 255;  ///< value of a cell with a surface in it

  /// Level surfaces are left out: the ground is everywhere.
  MapPyramid(const LaserMap& map, const Config& config);
  /// Of ground() and values() of one that was made of a map: only the windows are made anew.
  MapPyramid(GroundHeights ground, CellGrid values, const Config& config);

  [[nodiscard]] double cell_m() const { return cell_m_; }
  [[nodiscard]] int levels() const { return static_cast<int>(windows_.size()); }
  [[nodiscard]] const Eigen::Vector3i& min() const { return values_.min(); }
  [[nodiscard]] const Eigen::Vector3i& max() const { return values_.max(); }

  /// Of a cell: kFull with a surface, less beside one.
  [[nodiscard]] std::uint8_t value(int x, int y, int z) const { return values_.at(x, y, z); }

  [[nodiscard]] const CellGrid& values() const { return values_; }
  [[nodiscard]] const GroundHeights& ground() const { return ground_; }

  /// Columns are cut into slabs, so that what is known of a height makes bounds tighter. Of a cell
  /// and the ones above and below it; beyond the map the nearest.
  [[nodiscard]] int slab_of(int z) const {
    const int slab = (z - min().z()) / kSlab;
    return std::clamp(slab, 0, static_cast<int>(windows_.front().size()) - 2);
  }
  /// The slab that has all heights.
  [[nodiscard]] int any_height() const { return static_cast<int>(windows_.front().size()) - 1; }

  /// The largest values in windows of one size in a slab: one begins at each column.
  struct Windows {
    int x = 0;  ///< the first column
    int y = 0;
    std::uint32_t width = 0;  ///< [columns]
    std::uint32_t depth = 0;
    std::vector<std::uint8_t> values;  ///< x fastest

    /// In the window that begins at a column.
    [[nodiscard]] std::uint8_t largest(int x_column, int y_column) const {
      const auto ix = static_cast<std::uint32_t>(x_column - x);
      const auto iy = static_cast<std::uint32_t>(y_column - y);
      if (ix >= width || iy >= depth) return 0;
      return values[static_cast<std::size_t>(iy) * width + ix];
    }

    /// In the four windows that begin there, and so many columns further on along each axis.
    [[nodiscard]] std::uint8_t largest(int x_column, int y_column, int dx, int dy) const {
      const auto ix = static_cast<std::uint32_t>(x_column - x);
      const auto iy = static_cast<std::uint32_t>(y_column - y);
      const auto wide = static_cast<std::uint32_t>(dx);
      const auto deep = static_cast<std::uint32_t>(dy);
      if (ix < width && width - ix > wide && iy < depth && depth - iy > deep) {
        const std::uint8_t* near = &values[static_cast<std::size_t>(iy) * width + ix];
        const std::uint8_t* far = near + static_cast<std::size_t>(deep) * width;
        return std::max(std::max(near[0], near[wide]), std::max(far[0], far[wide]));
      }
      return std::max(
          std::max(largest(x_column, y_column), largest(x_column + dx, y_column)),
          std::max(largest(x_column, y_column + dy), largest(x_column + dx, y_column + dy)));
    }
  };

  /// Those of the columns [x, x + 2^level) x [y, y + 2^level), in a slab.
  [[nodiscard]] const Windows& windows(int level, int slab) const {
    return windows_[static_cast<std::size_t>(level)][static_cast<std::size_t>(slab)];
  }

  [[nodiscard]] std::size_t bytes() const;

 private:
  static constexpr int kSlab = 4;  // [cells]

  void make_windows(int levels);
  void add_columns();
  [[nodiscard]] Windows doubled(int level, int slab) const;

  double cell_m_;
  GroundHeights ground_;
  CellGrid values_;
  std::vector<std::vector<Windows>> windows_;  // by level and slab
};

}  // namespace fleetloc
