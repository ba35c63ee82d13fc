#include "deploy/sim/sensors/pixel_block.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>

namespace fleetloc {
namespace {

// The lattice has two nodes in each row, the other packets have two rows each. The two upper of
// them go by the nodes in the upper six rows, the others by those in the lower six: all columns
// have a node.
constexpr std::size_t kNodes = 12;
constexpr std::array<std::size_t, PixelBlock::kPackets> kFirstNode = {0, 0, 0, 4, 4};
constexpr std::uint32_t kAllNodes = (1U << kNodes) - 1U;
constexpr std::uint32_t kAllLanes = (1U << RayPacket::kSize) - 1U;
constexpr int kMinHits = 3;  // of a triangle among other objects, by the nodes

/// A few triangles or, without any, the sky.
class Patch {
 public:
  [[nodiscard]] std::span<const std::uint32_t> triangles() const {
    return {triangles_.data(), count_};
  }

  /// Smallest number of rays on one of the triangles.
  [[nodiscard]] int min_hits() const {
    return count_ == 0 ? 0 : *std::min_element(hits_.begin(), hits_.begin() + count_);
  }

  /// Counts one more ray; false if its triangle is one too many.
  bool add(std::uint32_t triangle) {
    const auto known = std::ranges::find(triangles(), triangle) - triangles().begin();
    const auto i = static_cast<std::size_t>(known);
    if (i == triangles_.size()) return false;
    if (i == count_) triangles_[count_++] = triangle;
    ++hits_[i];
    return true;
  }

 private:
  static constexpr std::size_t kMax = 8;
  std::array<std::uint32_t, kMax> triangles_{};
  std::array<int, kMax> hits_{};
  std::size_t count_ = 0;
};

/// The triangles of the upper or the lower rows of a block, if each node there has a ray and they
/// are one surface, or so large that the lattice cannot miss one between them.
std::optional<Patch> patch_of(const RayPacket& rays, const HitPacket& hits, std::size_t first) {
  Patch patch;
  bool is_one_object = true;
  for (std::size_t i = first; i < first + kNodes; ++i) {
    if (rays.max_m[i] < 0.0F) return std::nullopt;
    const bool is_sky = hits.distance_m[i] == HitPacket::kNone;
    if (!is_sky && !patch.add(hits.triangle[i])) return std::nullopt;
    const bool is_as_first = is_sky ? hits.distance_m[first] == HitPacket::kNone
                                    : hits.distance_m[first] != HitPacket::kNone &&
                                          hits.surface[i] == hits.surface[first];
    is_one_object = is_one_object && is_as_first;
  }
  if (!is_one_object && patch.min_hits() < kMinHits) return std::nullopt;
  return patch;
}

HitPacket hits_on(const RayCaster& caster, const Patch& patch, const RayPacket& rays) {
  if (!patch.triangles().empty()) return caster.first_hits_on(patch.triangles(), rays);
  HitPacket sky{};
  sky.distance_m.fill(HitPacket::kNone);
  sky.triangle.fill(HitPacket::kNoTriangle);
  return sky;
}

}  // namespace

PixelBlock::Shaded shade_block(const SceneView& view,
                               const Light& light,
                               const PixelBlock::Packets& packets) {
  PixelBlock::Shaded seen{};
  const HitPacket first = view.caster.first_hits(packets[0].rays);
  const std::uint32_t first_sunlit = sunlit(view, light, packets[0], first);
  seen.packets[0] = shade(view, light, packets[0], first);
  seen.sunlit[0] = first_sunlit;
  seen.triangles[0] = first.triangle;
  std::optional<Patch> patch;
  for (std::size_t i = 1; i < packets.size(); ++i) {
    const std::size_t node = kFirstNode.at(i);
    if (i == 1 || node != kFirstNode.at(i - 1)) patch = patch_of(packets[0].rays, first, node);
    const std::uint32_t nodes_sunlit = (first_sunlit >> node) & kAllNodes;
    const bool has_one_light = patch && (nodes_sunlit == 0U || nodes_sunlit == kAllNodes);
    const HitPacket hits = patch ? hits_on(view.caster, *patch, packets[i].rays)
                                 : view.caster.first_hits(packets[i].rays);
    seen.packets[i] = shade(view, light, packets[i], hits);
    seen.triangles[i] = hits.triangle;
    seen.sunlit[i] = has_one_light ? (nodes_sunlit == 0U ? 0U : kAllLanes)
                                   : sunlit(view, light, packets[i], hits);
  }
  return seen;
}

}  // namespace fleetloc
