#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

namespace fleetloc {

/// The cell that has a point. @param p  in units of cells
inline Eigen::Vector3i floored(const Eigen::Vector3d& p) {
  return p.array().floor().cast<int>();
}

/// A byte for each cell of a box; most are zero and take no memory: cells are kept in bricks of 8 x
/// 8 x 8. Cells outside of the box are zero, too.
class CellGrid {
 public:
  static constexpr std::uint32_t kEdge = 8;  // of a brick [cells]
  using Brick = std::array<std::uint8_t, kEdge * kEdge * kEdge>;

  CellGrid() : CellGrid(Eigen::Vector3i::Zero(), Eigen::Vector3i::Zero()) {}
  /// @param min,max  the first cell, and the one after the last, of each axis
  CellGrid(const Eigen::Vector3i& min, const Eigen::Vector3i& max);
  /// What directory() and bricks() have returned.
  /// @return nothing if they are not of one grid with these bounds, or it has a million cells along
  ///         an axis, or is a billion away
  static std::optional<CellGrid> of_parts(const Eigen::Vector3i& min,
                                          const Eigen::Vector3i& max,
                                          std::vector<std::uint32_t> directory,
                                          std::vector<Brick> bricks);

  [[nodiscard]] std::uint8_t at(int x, int y, int z) const {
    const auto ix = static_cast<std::uint32_t>(x - min_.x());
    const auto iy = static_cast<std::uint32_t>(y - min_.y());
    const auto iz = static_cast<std::uint32_t>(z - min_.z());
    const std::uint32_t bx = ix / kEdge;
    const std::uint32_t by = iy / kEdge;
    const std::uint32_t bz = iz / kEdge;
    if (bx >= size_[0] || by >= size_[1] || bz >= size_[2]) return 0;
    const std::uint32_t brick = directory_[(bz * size_[1] + by) * size_[0] + bx];
    return bricks_[brick][((iz % kEdge) * kEdge + iy % kEdge) * kEdge + ix % kEdge];
  }

  /// The cell, which is in the box, becomes at least `value`.
  void raise(const Eigen::Vector3i& cell, std::uint8_t value);

  /// Calls `each(cell, value)` for all cells that are not zero.
  template <typename Each>
  void for_each(Each each) const {
    for (std::uint32_t i = 0; i < directory_.size(); ++i) {
      if (directory_[i] == 0) continue;
      const Brick& brick = bricks_[directory_[i]];
      const Eigen::Vector3i corner = corner_of(i);
      for (std::uint32_t k = 0; k < brick.size(); ++k) {
        if (brick[k] != 0) each(Eigen::Vector3i(corner + within(k)), brick[k]);
      }
    }
  }

  [[nodiscard]] const Eigen::Vector3i& min() const { return min_; }
  [[nodiscard]] const Eigen::Vector3i& max() const { return max_; }
  /// Of each brick of the box its number in bricks(), x fastest.
  [[nodiscard]] const std::vector<std::uint32_t>& directory() const { return directory_; }
  [[nodiscard]] const std::vector<Brick>& bricks() const { return bricks_; }
  [[nodiscard]] std::size_t bytes() const;

 private:
  [[nodiscard]] Eigen::Vector3i corner_of(std::uint32_t entry) const;
  [[nodiscard]] static Eigen::Vector3i within(std::uint32_t k);

  Eigen::Vector3i min_;
  Eigen::Vector3i max_;
  std::array<std::uint32_t, 3> size_;  // [bricks]
  std::vector<std::uint32_t> directory_;
  std::vector<Brick> bricks_;  // the first one is zero
};

}  // namespace fleetloc
