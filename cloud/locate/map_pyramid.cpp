#include "cloud/locate/map_pyramid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace fleetloc {
namespace {

// A surface at `p` [cells] explains a landmark in its cell wholly, in a cell beside it by the
// distance to that one: a normal distribution of one cell. This is the share that one axis has in
// it, for the cell before that of `p`, its own, and the one behind.
std::array<double, 3> shares_along(double p) {
  const double before = p - std::floor(p);
  const double behind = 1.0 - before;
  return {std::exp(-0.5 * before * before), 1.0, std::exp(-0.5 * behind * behind)};
}

/// [cells], above the ground.
Eigen::Vector3d cells_at(const MapPoint& point, const GroundHeights& ground, double cell_m) {
  Eigen::Vector3d p = point.p_map.cast<double>();
  p.z() -= ground.at(p.x(), p.y());
  return p / cell_m;
}

CellGrid values_of(const LaserMap& map,
                   const GroundHeights& ground,
                   const MapPyramid::Config& config) {
  const auto stands = [&](const MapPoint& point) {
    return std::abs(static_cast<double>(point.normal.z())) <= config.level_from;
  };
  Eigen::Vector3i min = Eigen::Vector3i::Constant(std::numeric_limits<int>::max());
  Eigen::Vector3i max = Eigen::Vector3i::Constant(std::numeric_limits<int>::min());
  for (const MapPoint& point : map.points()) {
    if (!stands(point)) continue;
    const Eigen::Vector3i cell = floored(cells_at(point, ground, config.cell_m));
    min = min.cwiseMin(cell);
    max = max.cwiseMax(cell);
  }
  if (min.x() > max.x()) return {};  // all is level
  const Eigen::Vector3i margin = Eigen::Vector3i::Ones();
  CellGrid values(min - margin, max + 2 * margin);
  for (const MapPoint& point : map.points()) {
    if (!stands(point)) continue;
    const Eigen::Vector3d p = cells_at(point, ground, config.cell_m);
    const Eigen::Vector3i first = floored(p) - margin;
    const std::array<double, 3> along_x = shares_along(p.x());
    const std::array<double, 3> along_y = shares_along(p.y());
    const std::array<double, 3> along_z = shares_along(p.z());
    for (std::size_t z = 0; z < 3; ++z) {
      for (std::size_t y = 0; y < 3; ++y) {
        const double full = MapPyramid::kFull * along_z[z] * along_y[y];
        for (std::size_t x = 0; x < 3; ++x) {
          const Eigen::Vector3i beside =
              first + Eigen::Matrix<std::size_t, 3, 1>(x, y, z).cast<int>();
          values.raise(beside, static_cast<std::uint8_t>(full * along_x[x] + 0.5));
        }
      }
    }
  }
  return values;
}

}  // namespace

void MapPyramid::add_columns() {
  const Eigen::Vector3i size = max() - min();
  Windows empty{.x = min().x(),
                .y = min().y(),
                .width = static_cast<std::uint32_t>(size.x()),
                .depth = static_cast<std::uint32_t>(size.y()),
                .values = {}};
  empty.values.assign(static_cast<std::size_t>(empty.width) * empty.depth, 0);
  const int slabs = std::max(1, (size.z() + kSlab - 1) / kSlab);
  std::vector<Windows>& columns =
      windows_.emplace_back(static_cast<std::size_t>(slabs + 1), empty);  // and one of any height
  values_.for_each([&](const Eigen::Vector3i& cell, std::uint8_t value) {
    const auto x = static_cast<std::size_t>(cell.x() - empty.x);
    const auto y = static_cast<std::size_t>(cell.y() - empty.y);
    const auto raise = [&](int slab) {
      std::uint8_t& kept = columns[static_cast<std::size_t>(slab)].values[y * empty.width + x];
      kept = std::max(kept, value);
    };
    raise(any_height());
    for (const int beside : {-1, 0, 1}) raise(slab_of(cell.z() + beside));
  });
}

// Four windows of `level`, which is the last one, make one of twice the edge.
MapPyramid::Windows MapPyramid::doubled(int level, int slab) const {
  const Windows& half = windows(level, slab);
  const int step = 1 << level;
  Windows result{.x = half.x - step,
                 .y = half.y - step,
                 .width = half.width + static_cast<std::uint32_t>(step),
                 .depth = half.depth + static_cast<std::uint32_t>(step),
                 .values = {}};
  result.values.reserve(static_cast<std::size_t>(result.width) * result.depth);
  for (int iy = 0; iy < static_cast<int>(result.depth); ++iy) {
    for (int ix = 0; ix < static_cast<int>(result.width); ++ix) {
      const int x = result.x + ix;
      const int y = result.y + iy;
      result.values.push_back(std::max({half.largest(x, y),
                                        half.largest(x + step, y),
                                        half.largest(x, y + step),
                                        half.largest(x + step, y + step)}));
    }
  }
  return result;
}

MapPyramid::MapPyramid(const LaserMap& map, const Config& config)
    : cell_m_(config.cell_m),
      ground_(map, config.level_from),
      values_(values_of(map, ground_, config)) {
  make_windows(config.levels);
}

MapPyramid::MapPyramid(GroundHeights ground, CellGrid values, const Config& config)
    : cell_m_(config.cell_m), ground_(std::move(ground)), values_(std::move(values)) {
  make_windows(config.levels);
}

void MapPyramid::make_windows(int levels) {
  windows_.reserve(static_cast<std::size_t>(levels));
  add_columns();
  for (int level = 1; level < levels; ++level) {
    std::vector<Windows> next;
    for (int slab = 0; slab <= any_height(); ++slab) next.push_back(doubled(level - 1, slab));
    windows_.push_back(std::move(next));
  }
}

std::size_t MapPyramid::bytes() const {
  std::size_t sum = ground_.bytes() + values_.bytes();
  for (const auto& slabs : windows_) {
    for (const Windows& windows : slabs) sum += windows.values.size();
  }
  return sum;
}

}  // namespace fleetloc
