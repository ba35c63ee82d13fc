#include "cloud/locate/map_pyramid.hpp"

#include <algorithm>
#include <cmath>

namespace fleetloc {
namespace {

// A surface at `p` [cells] explains a landmark in its cell wholly, in a cell beside it by the
// distance to that one: a normal distribution of one cell.
std::uint8_t value_in(const Eigen::Vector3d& p, const Eigen::Vector3i& cell) {
  const Eigen::Array3d low = cell.cast<double>().array() - p.array();
  const Eigen::Array3d beside = low.max(-low - 1.0).max(0.0);
  return static_cast<std::uint8_t>(
      std::lround(MapPyramid::kFull * std::exp(-0.5 * beside.square().sum())));
}

CellGrid values_of(const LaserMap& map, const MapPyramid::Config& config) {
  const auto cell = [&](const Eigen::Vector3d& p_map) -> Eigen::Vector3i {
    return (p_map / config.cell_m).array().floor().cast<int>();
  };
  const Eigen::Vector3i margin = Eigen::Vector3i::Ones();
  CellGrid values(cell(map.info().min) - margin, cell(map.info().max) + 2 * margin);
  for (const MapPoint& point : map.points()) {
    if (std::abs(static_cast<double>(point.normal.z())) > config.level_from) continue;
    const Eigen::Vector3d p = point.p_map.cast<double>() / config.cell_m;
    const Eigen::Vector3i at = p.array().floor().cast<int>();
    for (int z = -1; z <= 1; ++z) {
      for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) {
          const Eigen::Vector3i beside = at + Eigen::Vector3i(x, y, z);
          values.raise(beside, value_in(p, beside));
        }
      }
    }
  }
  return values;
}

}  // namespace

MapPyramid::Window MapPyramid::columns_of(const CellGrid& values) {
  const Eigen::Vector3i size = values.max() - values.min();
  Window columns{.x = values.min().x(),
                 .y = values.min().y(),
                 .width = static_cast<std::uint32_t>(size.x()),
                 .depth = static_cast<std::uint32_t>(size.y()),
                 .values = {}};
  columns.values.assign(static_cast<std::size_t>(columns.width) * columns.depth, 0);
  values.for_each([&](const Eigen::Vector3i& cell, std::uint8_t value) {
    const auto x = static_cast<std::size_t>(cell.x() - columns.x);
    const auto y = static_cast<std::size_t>(cell.y() - columns.y);
    std::uint8_t& kept = columns.values[y * columns.width + x];
    kept = std::max(kept, value);
  });
  return columns;
}

// Four windows of `level`, which is the last one, make one of twice the edge.
MapPyramid::Window MapPyramid::doubled(const MapPyramid& map, int level) {
  const Window& half = map.windows_.back();
  const int step = 1 << level;
  Window result{.x = half.x - step,
                .y = half.y - step,
                .width = half.width + static_cast<std::uint32_t>(step),
                .depth = half.depth + static_cast<std::uint32_t>(step),
                .values = {}};
  result.values.reserve(static_cast<std::size_t>(result.width) * result.depth);
  for (int iy = 0; iy < static_cast<int>(result.depth); ++iy) {
    for (int ix = 0; ix < static_cast<int>(result.width); ++ix) {
      const int x = result.x + ix;
      const int y = result.y + iy;
      result.values.push_back(std::max({map.largest(level, x, y),
                                        map.largest(level, x + step, y),
                                        map.largest(level, x, y + step),
                                        map.largest(level, x + step, y + step)}));
    }
  }
  return result;
}

MapPyramid::MapPyramid(const LaserMap& map, const Config& config)
    : cell_m_(config.cell_m), values_(values_of(map, config)) {
  windows_.push_back(columns_of(values_));
  for (int level = 1; level < config.levels; ++level) {
    windows_.push_back(doubled(*this, level - 1));
  }
}

std::size_t MapPyramid::bytes() const {
  std::size_t sum = values_.bytes();
  for (const Window& window : windows_) sum += window.values.size();
  return sum;
}

}  // namespace fleetloc
