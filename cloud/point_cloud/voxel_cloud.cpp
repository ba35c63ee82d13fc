#include "cloud/point_cloud/voxel_cloud.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace fleetloc {
namespace {

constexpr int kBits = 21;  // per coordinate
constexpr std::uint64_t kMask = (std::uint64_t{1} << kBits) - 1;
constexpr std::int64_t kOffset = std::int64_t{1} << (kBits - 1);
constexpr std::size_t kFirstSlots = 1024;

using Cell = Eigen::Matrix<std::int64_t, 3, 1>;

std::uint64_t key_of(const Cell& cell) {
  const auto part = [&](int axis) { return static_cast<std::uint64_t>(cell[axis] + kOffset); };
  return (part(0) << (2 * kBits)) | (part(1) << kBits) | part(2);
}

Cell cell_of(std::uint64_t key) {
  const auto part = [&](int shift) {
    return static_cast<std::int64_t>((key >> shift) & kMask) - kOffset;
  };
  return {part(2 * kBits), part(kBits), part(0)};
}

std::size_t slot_of(std::uint64_t key, std::size_t slots) {
  std::uint64_t hash = key * 0x9e3779b97f4a7c15U;
  hash ^= hash >> 32U;
  return static_cast<std::size_t>(hash) & (slots - 1);
}

}  // namespace

VoxelCloud::VoxelCloud(double edge_m, std::size_t max_voxels)
    : edge_m_(edge_m), max_voxels_(max_voxels), slots_(kFirstSlots) {
  assert(edge_m > 0.0 && max_voxels >= 8);
}

void VoxelCloud::add(const Eigen::Vector3d& p) {
  const Eigen::Vector3d place = p / edge_m_;
  if (!(place.cwiseAbs().maxCoeff() < static_cast<double>(kOffset) - 1.0)) return;
  const Eigen::Vector3d corner = place.array().floor();
  const Eigen::Vector3d within = p - edge_m_ * corner;
  insert(key_of(corner.cast<std::int64_t>()), within.cast<float>(), 1);
  while (size_ > max_voxels_) coarsen();
}

void VoxelCloud::insert(std::uint64_t key, const Eigen::Vector3f& sum, std::uint32_t count) {
  if (2 * (size_ + 1) > slots_.size()) {
    std::vector<Voxel> before = std::exchange(slots_, std::vector<Voxel>(2 * slots_.size()));
    size_ = 0;
    for (const Voxel& voxel : before) {
      if (voxel.count > 0) insert(voxel.key, voxel.sum, voxel.count);
    }
  }
  std::size_t slot = slot_of(key, slots_.size());
  while (slots_[slot].count > 0 && slots_[slot].key != key) slot = (slot + 1) & (slots_.size() - 1);
  Voxel& voxel = slots_[slot];
  if (voxel.count == 0) ++size_;
  voxel.key = key;
  voxel.sum += sum;
  voxel.count += count;
}

void VoxelCloud::coarsen() {
  const std::vector<Voxel> before = std::exchange(slots_, std::vector<Voxel>(slots_.size()));
  size_ = 0;
  for (const Voxel& voxel : before) {
    if (voxel.count == 0) continue;
    const Cell cell = cell_of(voxel.key);
    const Cell parent = cell.unaryExpr([](std::int64_t x) { return x >> 1; });
    const Eigen::Vector3d moved = edge_m_ * (cell - 2 * parent).cast<double>();
    const auto count = static_cast<float>(voxel.count);
    insert(key_of(parent), voxel.sum + count * moved.cast<float>(), voxel.count);
  }
  edge_m_ *= 2.0;
}

std::vector<Eigen::Vector3f> VoxelCloud::points() const {
  std::vector<const Voxel*> voxels;
  voxels.reserve(size_);
  for (const Voxel& voxel : slots_) {
    if (voxel.count > 0) voxels.push_back(&voxel);
  }
  std::ranges::sort(voxels, {}, &Voxel::key);
  std::vector<Eigen::Vector3f> points;
  points.reserve(voxels.size());
  for (const Voxel* voxel : voxels) {
    const Eigen::Vector3d mean = voxel->sum.cast<double>() / voxel->count;
    points.emplace_back((edge_m_ * cell_of(voxel->key).cast<double>() + mean).cast<float>());
  }
  return points;
}

}  // namespace fleetloc
