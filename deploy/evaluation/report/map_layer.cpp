#include "deploy/evaluation/report/map_layer.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace fleetloc {
namespace {

constexpr double kLayer_m = 0.25;  // heights in one layer count as one
constexpr int kLayers = 64;        // heights repeat beyond; a wall stays one
constexpr int kWallLayers = 4;

/// Which layers of height each cell has points in, row by row from the lower left.
struct MapCells {
  MapCells(const View& view, double side_px)
      : side_m(side_px * view.metres_per_px),
        columns(static_cast<int>(std::ceil(view.width_px / side_px))),
        rows(static_cast<int>(std::ceil(view.height_px / side_px))),
        layers(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows)) {}

  [[nodiscard]] std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(column);
  }

  double side_m;
  int columns;
  int rows;
  std::vector<std::uint64_t> layers;
  std::size_t points = 0;  // in the view
};

MapCells cells_of(std::span<const Eigen::Vector3f> points, const View& view, double side_px) {
  MapCells cells(view, side_px);
  for (const Eigen::Vector3f& point : points) {
    if (!point.allFinite()) continue;
    const Eigen::Vector2d at =
        (point.head<2>().cast<double>() - view.corner_m).array() / cells.side_m;
    if (at.minCoeff() < 0.0 || at.x() >= cells.columns || at.y() >= cells.rows) continue;
    const auto layer = static_cast<std::int64_t>(std::floor(double{point.z()} / kLayer_m));
    cells.layers[cells.index(static_cast<int>(at.y()), static_cast<int>(at.x()))] |=
        std::uint64_t{1} << static_cast<unsigned>(layer & (kLayers - 1));
    ++cells.points;
  }
  return cells;
}

bool is_dense(const MapCells& cells) {
  constexpr std::ptrdiff_t kPointsPerCell = 4;
  const auto empty = std::ranges::count(cells.layers, std::uint64_t{0});
  const auto filled = static_cast<std::ptrdiff_t>(cells.layers.size()) - empty;
  return static_cast<std::ptrdiff_t>(cells.points) >= kPointsPerCell * filled;
}

enum class Kind { kNothing, kLight, kDark };

Kind kind(const MapCells& cells, int row, int column) {
  const int layers = std::popcount(cells.layers[cells.index(row, column)]);
  if (layers == 0) return Kind::kNothing;
  return layers >= kWallLayers ? Kind::kDark : Kind::kLight;
}

void add_runs(const MapCells& cells, const View& view, int row, MapLayer& layer) {
  const double y = view.corner_m.y() + (row + 0.5) * cells.side_m;
  for (int begin = 0, end = 0; begin < cells.columns; begin = end) {
    const Kind its = kind(cells, row, begin);
    end = begin + 1;
    while (end < cells.columns && kind(cells, row, end) == its) ++end;
    if (its == Kind::kNothing) continue;
    auto& runs = its == Kind::kDark ? layer.dark : layer.light;
    runs.push_back({view.corner_m.x() + begin * cells.side_m, y});
    runs.push_back({view.corner_m.x() + end * cells.side_m, y});
    runs.emplace_back();
  }
}

}  // namespace

MapLayer map_layer(std::span<const Eigen::Vector3f> points, const View& view) {
  constexpr double kMin_px = 2.0;
  constexpr double kMax_px = 8.0;
  constexpr std::size_t kMaxRows = 18'000;  // a third of a megabyte in a page
  double side_px = kMin_px;
  while (true) {
    const MapCells cells = cells_of(points, view, side_px);
    MapLayer layer{.cell_px = side_px, .light = {}, .dark = {}};
    for (int row = 0; row < cells.rows; ++row) add_runs(cells, view, row, layer);
    const bool is_small = layer.light.size() + layer.dark.size() <= kMaxRows;
    if (side_px >= kMax_px || (is_small && is_dense(cells))) return layer;
    ++side_px;
  }
}

}  // namespace fleetloc
