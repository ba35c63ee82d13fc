#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace fleetloc {

/// Voxel filter of a stream of points: one point per voxel, the mean of those in it. Memory is
/// bounded: where there would be more than `max_voxels`, the edge of all voxels is doubled and
/// neighbours are merged. The result depends on the points and their order alone.
class VoxelCloud {
 public:
  /// @param edge_m       positive
  /// @param max_voxels  at least 8; 40 bytes each, at most
  VoxelCloud(double edge_m, std::size_t max_voxels);

  /// Points farther than 2^20 voxels from the origin, or not finite, are left out.
  void add(const Eigen::Vector3d& p);

  [[nodiscard]] double edge_m() const { return edge_m_; }  ///< current
  [[nodiscard]] std::size_t size() const { return size_; }

  /// In the order of the voxels: by x, then y, then z.
  [[nodiscard]] std::vector<Eigen::Vector3f> points() const;

 private:
  struct Voxel {
    std::uint64_t key = 0;
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();  ///< relative to the voxel's corner [m]
    std::uint32_t count = 0;                        ///< 0: the slot is free
  };

  void insert(std::uint64_t key, const Eigen::Vector3f& sum, std::uint32_t count);
  void coarsen();

  double edge_m_;
  std::size_t max_voxels_;
  std::size_t size_ = 0;
  std::vector<Voxel> slots_;  ///< a power of two; open addressing
};

}  // namespace fleetloc
