#pragma once

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace fleetloc {

/// The part of the map that a figure shows, from above, one scale for both axes.
struct View {
  Eigen::Vector2d corner_m = Eigen::Vector2d::Zero();  ///< lower left
  double metres_per_px = 1.0;
  int width_px = 0;
  int height_px = 0;

  [[nodiscard]] Eigen::Vector2d size_m() const {
    return metres_per_px * Eigen::Vector2d(width_px, height_px);
  }
};

/// Horizontal runs of cells that hold points: rows of x, y [m], two of them a run, with an empty
/// row after it. Light: some points; dark: points at several heights, as a wall has them.
struct MapLayer {
  double cell_px = 0.0;  ///< side of a cell
  std::vector<std::vector<double>> light;
  std::vector<std::vector<double>> dark;
};

/// Thins the map to cells that are as small as its density and the size of a page allow, of 2 px or
/// more.
MapLayer map_layer(std::span<const Eigen::Vector3f> points, const View& view);

}  // namespace fleetloc
