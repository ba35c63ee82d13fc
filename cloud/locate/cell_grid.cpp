#include "cloud/locate/cell_grid.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace fleetloc {

namespace {

std::array<std::uint32_t, 3> size_in_bricks(const Eigen::Vector3i& min,
                                            const Eigen::Vector3i& max) {
  constexpr std::int64_t kEdge = CellGrid::kEdge;
  std::array<std::uint32_t, 3> size{};
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t cells = std::max<std::int64_t>(0, std::int64_t{max(axis)} - min(axis));
    size[static_cast<std::size_t>(axis)] = static_cast<std::uint32_t>((cells + kEdge - 1) / kEdge);
  }
  return size;
}

std::size_t product(const std::array<std::uint32_t, 3>& size) {
  return std::size_t{size[0]} * size[1] * size[2];
}

}  // namespace

CellGrid::CellGrid(const Eigen::Vector3i& min, const Eigen::Vector3i& max)
    : min_(min),
      max_(max),
      size_(size_in_bricks(min, max)),
      directory_(product(size_), 0),
      bricks_(1) {}

std::optional<CellGrid> CellGrid::of_parts(const Eigen::Vector3i& min,
                                           const Eigen::Vector3i& max,
                                           std::vector<std::uint32_t> directory,
                                           std::vector<Brick> bricks) {
  constexpr std::int64_t kMaxEdge = 1 << 20;   // [cells]; so that no product overflows
  constexpr std::int64_t kFarthest = 1 << 30;  // nor any sum
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t edge = std::int64_t{max(axis)} - min(axis);
    const bool is_near = min(axis) >= -kFarthest && max(axis) <= kFarthest;
    if (edge < 0 || edge > kMaxEdge || !is_near) return std::nullopt;
  }
  const std::array<std::uint32_t, 3> size = size_in_bricks(min, max);
  const bool is_flat = product(size) == 0 && min != max;  // without bricks it could have any size
  const auto exists = [&](std::uint32_t brick) { return brick < bricks.size(); };
  const bool is_first_empty = !bricks.empty() && bricks.front() == Brick{};
  if (is_flat || directory.size() != product(size) || !is_first_empty ||
      !std::ranges::all_of(directory, exists)) {
    return std::nullopt;
  }
  CellGrid grid;
  grid.min_ = min;
  grid.max_ = max;
  grid.size_ = size;
  grid.directory_ = std::move(directory);
  grid.bricks_ = std::move(bricks);
  bool is_inside = true;  // none in what bricks have beyond the box
  grid.for_each([&](const Eigen::Vector3i& cell, std::uint8_t) {
    is_inside = is_inside && (cell.array() < max.array()).all();
  });
  if (!is_inside) return std::nullopt;
  return grid;
}

void CellGrid::raise(const Eigen::Vector3i& cell, std::uint8_t value) {
  assert((cell.array() >= min_.array()).all() && (cell.array() < max_.array()).all());
  const Eigen::Matrix<std::uint32_t, 3, 1> i = (cell - min_).cast<std::uint32_t>();
  const Eigen::Matrix<std::uint32_t, 3, 1> b = i / kEdge;
  std::uint32_t& brick = directory_[(b.z() * size_[1] + b.y()) * size_[0] + b.x()];
  if (brick == 0) {
    brick = static_cast<std::uint32_t>(bricks_.size());
    bricks_.emplace_back();
  }
  std::uint8_t& kept =
      bricks_[brick][((i.z() % kEdge) * kEdge + i.y() % kEdge) * kEdge + i.x() % kEdge];
  kept = std::max(kept, value);
}

Eigen::Vector3i CellGrid::corner_of(std::uint32_t entry) const {
  const Eigen::Matrix<std::uint32_t, 3, 1> brick(
      entry % size_[0], entry / size_[0] % size_[1], entry / size_[0] / size_[1]);
  return min_ + (kEdge * brick).cast<int>();
}

Eigen::Vector3i CellGrid::within(std::uint32_t k) {
  return Eigen::Matrix<std::uint32_t, 3, 1>(k % kEdge, k / kEdge % kEdge, k / kEdge / kEdge)
      .cast<int>();
}

std::size_t CellGrid::bytes() const {
  return directory_.size() * sizeof(std::uint32_t) + bricks_.size() * sizeof(Brick);
}

}  // namespace fleetloc
