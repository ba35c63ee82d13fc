#include "cloud/mapping/evidence_grid.hpp"

#include <cassert>
#include <cmath>
#include <utility>

namespace fleetloc {
namespace {

constexpr std::size_t kFirstSlots = 1024;

std::size_t slot_of(std::uint64_t key, std::size_t slots) {
  std::uint64_t hash = key * 0x9e3779b97f4a7c15U;
  hash ^= hash >> 32U;
  return static_cast<std::size_t>(hash) & (slots - 1);
}

}  // namespace

VoxelTraversal::VoxelTraversal(const Eigen::Vector3d& from, const Eigen::Vector3d& to)
    : cell_(from.array().floor().cast<std::int32_t>()) {
  constexpr double kNever = 1e30;
  const Eigen::Vector3d segment = to - from;
  for (int axis = 0; axis < 3; ++axis) {
    const double along = segment[axis];
    const double face = cell_[axis] + (along > 0.0 ? 1.0 : 0.0);
    direction_[axis] = along > 0.0 ? 1 : -1;
    between_[axis] = along == 0.0 ? kNever : 1.0 / std::abs(along);
    next_[axis] = along == 0.0 ? kNever : (face - from[axis]) / along;
  }
  const Coordinates end = to.array().floor().cast<std::int32_t>();
  steps_ = (end - cell_).cwiseAbs().sum();
}

EvidenceGrid::EvidenceGrid(std::span<const Eigen::Vector3f> points_map, double cell_m)
    : cell_m_(cell_m), slots_(kFirstSlots) {
  assert(cell_m > 0.0);
  for (const Eigen::Vector3f& p_map : points_map) {
    const Coordinates at = coordinates_of(p_map.cast<double>());
    const int place = place_in_block(at);
    block_for(key_of(at)).occupied[static_cast<std::size_t>(place) / 64] |=
        std::uint64_t{1} << (static_cast<unsigned int>(place) % 64U);
  }
  number_cells();
  fit_surfaces(points_map);
}

EvidenceGrid::Coordinates EvidenceGrid::coordinates_of(const Eigen::Vector3d& p_map) const {
  return (p_map / cell_m_).array().floor().cast<std::int32_t>();
}

std::optional<std::size_t> EvidenceGrid::find(const Eigen::Vector3d& p_map) const {
  return index_at(coordinates_of(p_map));
}

std::optional<std::size_t> EvidenceGrid::index_at(const Coordinates& at) const {
  const Block* block = block_at(key_of(at));
  if (block == nullptr) return std::nullopt;
  return index_in(*block, place_in_block(at));
}

const EvidenceGrid::Block* EvidenceGrid::block_at(std::uint64_t key) const {
  std::size_t slot = slot_of(key, slots_.size());
  while (slots_[slot].key != key) {
    if (slots_[slot].key == kFree) return nullptr;
    slot = (slot + 1) & (slots_.size() - 1);
  }
  return &blocks_[slots_[slot].block];
}

EvidenceGrid::Block& EvidenceGrid::block_for(std::uint64_t key) {
  if (2 * (blocks_.size() + 1) > slots_.size()) grow_slots();
  std::size_t slot = slot_of(key, slots_.size());
  while (slots_[slot].key != key) {
    if (slots_[slot].key == kFree) {
      slots_[slot] = {.key = key, .block = static_cast<std::uint32_t>(blocks_.size())};
      blocks_.emplace_back();
      break;
    }
    slot = (slot + 1) & (slots_.size() - 1);
  }
  return blocks_[slots_[slot].block];
}

void EvidenceGrid::grow_slots() {
  const std::vector<Slot> before = std::exchange(slots_, std::vector<Slot>(2 * slots_.size()));
  for (const Slot& moved : before) {
    if (moved.key == kFree) continue;
    std::size_t slot = slot_of(moved.key, slots_.size());
    while (slots_[slot].key != kFree) slot = (slot + 1) & (slots_.size() - 1);
    slots_[slot] = moved;
  }
}

void EvidenceGrid::number_cells() {
  std::uint32_t cells = 0;
  for (Block& block : blocks_) {
    for (std::size_t word = 0; word < kWords; ++word) {
      block.first[word] = cells;
      cells += static_cast<std::uint32_t>(std::popcount(block.occupied[word]));
    }
  }
  cells_.resize(cells);
}

void EvidenceGrid::fit_surfaces(std::span<const Eigen::Vector3f> points_map) {
  std::vector<PointMoments> moments(cells_.size());  // about the cells' corners
  std::vector<Coordinates> places(cells_.size());
  const auto corner = [this](const Coordinates& at) -> Eigen::Vector3d {
    return cell_m_ * at.cast<double>();
  };
  for (const Eigen::Vector3f& p_map : points_map) {
    const Coordinates at = coordinates_of(p_map.cast<double>());
    const std::size_t index = index_at(at).value();
    places[index] = at;
    moments[index].add((p_map.cast<double>() - corner(at)).cast<float>());
  }
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    PointMoments around;
    for (int neighbour = 0; neighbour < 27; ++neighbour) {
      const Coordinates step(neighbour / 9 - 1, neighbour / 3 % 3 - 1, neighbour % 3 - 1);
      if (const auto index = index_at(Coordinates(places[i] + step))) {
        around.add(moments[*index], static_cast<float>(cell_m_) * step.cast<float>());
      }
    }
    cells_[i] = surface_of(moments[i], around, corner(places[i]).cast<float>());
  }
}

}  // namespace fleetloc
