#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "cloud/mapping/surface_cell.hpp"

namespace fleetloc {

/// Steps through the cells that a line segment passes (Amanatides and Woo, A fast voxel traversal
/// algorithm for ray tracing, 1987). Lengths are in cells.
class VoxelTraversal {
 public:
  using Coordinates = Eigen::Matrix<std::int32_t, 3, 1>;

  VoxelTraversal(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

  [[nodiscard]] const Coordinates& cell() const { return cell_; }
  [[nodiscard]] int steps() const { return steps_; }  ///< to the cell of the end

  void step() {
    int axis = next_[0] < next_[1] ? 0 : 1;
    if (next_[2] < next_[axis]) axis = 2;
    cell_[axis] += direction_[axis];
    next_[axis] += between_[axis];
  }

 private:
  Coordinates cell_;
  Coordinates direction_;    ///< 1 or -1
  Eigen::Vector3d next_;     ///< the next faces, as shares of the segment
  Eigen::Vector3d between_;  ///< and from face to face
  int steps_ = 0;
};

/// Sparse voxel grid of the cells that hold points, with the surface in each. Immutable.
class EvidenceGrid {
 public:
  /// @param points_map  within 2^20 blocks of 8 cells from the origin [m]
  EvidenceGrid(std::span<const Eigen::Vector3f> points_map, double cell_m);

  [[nodiscard]] std::size_t size() const { return cells_.size(); }
  [[nodiscard]] double cell_m() const { return cell_m_; }
  [[nodiscard]] const SurfaceCell& cell(std::size_t index) const { return cells_[index]; }

  /// Index of the cell around a position; nothing if that cell holds no point.
  [[nodiscard]] std::optional<std::size_t> find(const Eigen::Vector3d& p_map) const;

  /// Calls `visit(index)` for each cell with points that the segment passes, in its order [m].
  template <typename Visit>
  void traverse(const Eigen::Vector3d& from_map,
                const Eigen::Vector3d& to_map,
                const Visit& visit) const;

 private:
  using Coordinates = VoxelTraversal::Coordinates;

  static constexpr int kBlockBits = 3;
  static constexpr int kWords = 8;  // of 64 cells each

  /// 8 x 8 x 8 cells: which of them hold points, and where these begin in cells_.
  struct Block {
    std::array<std::uint64_t, kWords> occupied{};
    std::array<std::uint32_t, kWords> first{};
  };
  struct Slot {
    std::uint64_t key = kFree;
    std::uint32_t block = 0;
  };
  static constexpr std::uint64_t kFree = ~std::uint64_t{0};

  [[nodiscard]] Coordinates coordinates_of(const Eigen::Vector3d& p_map) const;
  [[nodiscard]] const Block* block_at(std::uint64_t key) const;
  [[nodiscard]] std::optional<std::size_t> index_at(const Coordinates& at) const;
  Block& block_for(std::uint64_t key);
  void grow_slots();
  void number_cells();
  void fit_surfaces(std::span<const Eigen::Vector3f> points_map);

  static std::uint64_t key_of(const Coordinates& at);
  static int place_in_block(const Coordinates& at);
  static std::optional<std::size_t> index_in(const Block& block, int place);

  double cell_m_;
  std::vector<Slot> slots_;  ///< a power of two; open addressing
  std::vector<Block> blocks_;
  std::vector<SurfaceCell> cells_;
};

template <typename Visit>
void EvidenceGrid::traverse(const Eigen::Vector3d& from_map,
                            const Eigen::Vector3d& to_map,
                            const Visit& visit) const {
  VoxelTraversal traversal(from_map / cell_m_, to_map / cell_m_);
  std::uint64_t key = kFree;
  const Block* block = nullptr;
  for (int left = traversal.steps(); left >= 0; --left) {
    if (const std::uint64_t here = key_of(traversal.cell()); here != key) {
      key = here;
      block = block_at(key);
    }
    if (block != nullptr) {
      if (const auto index = index_in(*block, place_in_block(traversal.cell()))) visit(*index);
    }
    traversal.step();
  }
}

inline std::uint64_t EvidenceGrid::key_of(const Coordinates& at) {
  constexpr int kBits = 21;
  constexpr std::int32_t kOffset = std::int32_t{1} << (kBits - 1);
  const auto part = [&at](int axis) {
    const std::int32_t block = (at[axis] >> kBlockBits) + kOffset;
    return static_cast<std::uint64_t>(block);
  };
  return (part(0) << (2 * kBits)) | (part(1) << kBits) | part(2);
}

inline int EvidenceGrid::place_in_block(const Coordinates& at) {
  constexpr std::int32_t kMask = (1 << kBlockBits) - 1;
  return ((at[0] & kMask) << (2 * kBlockBits)) | ((at[1] & kMask) << kBlockBits) | (at[2] & kMask);
}

inline std::optional<std::size_t> EvidenceGrid::index_in(const Block& block, int place) {
  const auto word = static_cast<std::size_t>(place) / 64;
  const std::uint64_t bit = std::uint64_t{1} << (static_cast<unsigned int>(place) % 64U);
  if ((block.occupied[word] & bit) == 0) return std::nullopt;
  return block.first[word] +
         static_cast<std::size_t>(std::popcount(block.occupied[word] & (bit - 1)));
}

}  // namespace fleetloc
