#include "cloud/locate/cell_grid.hpp"

#include <algorithm>
#include <cassert>

namespace fleetloc {

CellGrid::CellGrid(const Eigen::Vector3i& min, const Eigen::Vector3i& max)
    : min_(min), max_(max), size_{} {
  std::size_t count = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const auto cells = static_cast<std::uint32_t>(std::max(0, max(axis) - min(axis)));
    size_[static_cast<std::size_t>(axis)] = (cells + kEdge - 1) / kEdge;
    count *= size_[static_cast<std::size_t>(axis)];
  }
  directory_.assign(count, 0);
  bricks_.emplace_back();
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
