#include "deploy/sim/world/ray_caster.hpp"

#include <algorithm>

#include "deploy/sim/world/packet_triangle.hpp"
#include "deploy/sim/world/triangle_tree.hpp"

namespace fleetloc {
namespace {

constexpr float kSurfaceSkin_m = 0.002F;
constexpr std::uint32_t kMoving = 0x80000000U;  // marks the numbers of triangles that move

bool is_empty(const RayPacket& rays) {
  return std::ranges::all_of(rays.max_m, [](float max_m) { return max_m < 0.0F; });
}

HitPacket no_hits() {
  HitPacket hits{};
  hits.distance_m.fill(HitPacket::kNone);
  hits.triangle.fill(HitPacket::kNoTriangle);
  return hits;
}

}  // namespace

RayCaster::RayCaster(const Mesh& fixed) : fixed_(std::make_shared<const TriangleTree>(fixed)) {}

RayCaster RayCaster::with(const Mesh& moving) const {
  RayCaster result;
  result.fixed_ = fixed_;
  result.moving_ = std::make_shared<const TriangleTree>(moving, kMoving);
  return result;
}

std::optional<Hit> RayCaster::first_hit(const Ray& ray, float max_m) const {
  std::optional<Hit> first = fixed_->first_hit(ray, max_m);
  if (!moving_) return first;
  std::optional<Hit> nearer = moving_->first_hit(ray, first ? first->distance_m : max_m);
  return nearer ? nearer : first;
}

HitPacket RayCaster::first_hits(const RayPacket& rays) const {
  HitPacket hits = no_hits();
  if (is_empty(rays)) return hits;
  fixed_->first_hits(rays, hits);
  if (moving_) moving_->first_hits(rays, hits);
  return hits;
}

HitPacket RayCaster::first_hits_on(std::span<const std::uint32_t> triangles,
                                   const RayPacket& rays) const {
  HitPacket hits = no_hits();
  for (const std::uint32_t triangle : triangles) {
    intersect_triangle(
        corners(triangle), {.triangle = triangle, .surface = surface(triangle)}, rays, hits);
  }
  trace_rest(rays, hits);
  return hits;
}

HitPacket RayCaster::first_hits_on_pairs(const TrianglePairs& triangles,
                                         const RayPacket& rays) const {
  HitPacket hits = no_hits();
  for (const auto& of_rays : triangles) {
    LaneTriangles own;
    own.triangle = of_rays;
    for (std::size_t i = 0; i < of_rays.size(); ++i) {
      if (of_rays[i] == HitPacket::kNoTriangle || rays.max_m[i] < 0.0F) continue;
      own.set(i, corners(of_rays[i]), surface(of_rays[i]));
    }
    intersect_lane_triangles(own, rays, hits);
  }
  return hits;
}

void RayCaster::trace_rest(const RayPacket& rays, HitPacket& hits) const {
  RayPacket rest = rays;
  for (std::size_t i = 0; i < RayPacket::kSize; ++i) {
    if (hits.distance_m[i] != HitPacket::kNone) rest.max_m[i] = -1.0F;
  }
  if (is_empty(rest)) return;
  fixed_->first_hits(rest, hits);
  if (moving_) moving_->first_hits(rest, hits);
}

std::array<Eigen::Vector3f, 3> RayCaster::corners(std::uint32_t triangle) const {
  return ((triangle & kMoving) != 0U ? *moving_ : *fixed_).corners(triangle & ~kMoving);
}

std::uint32_t RayCaster::surface(std::uint32_t triangle) const {
  return ((triangle & kMoving) != 0U ? *moving_ : *fixed_).surface(triangle & ~kMoving);
}

bool RayCaster::occluded(const Eigen::Vector3f& from_map, const Eigen::Vector3f& to_map) const {
  const Eigen::Vector3f way = to_map - from_map;
  const float distance = way.norm();
  if (distance <= 2.0F * kSurfaceSkin_m) return false;
  const Ray ray{.origin_map = from_map, .direction_map = way / distance};
  const float max_m = distance - kSurfaceSkin_m;
  return fixed_->occluded(ray, kSurfaceSkin_m, max_m) ||
         (moving_ && moving_->occluded(ray, kSurfaceSkin_m, max_m));
}

std::uint32_t RayCaster::occluded(const RayPacket& rays) const {
  if (is_empty(rays)) return 0;
  const std::uint32_t bits = fixed_->occluded(rays);
  return moving_ ? bits | moving_->occluded(rays) : bits;
}

bool RayCaster::has_surface_within(const Eigen::Vector3f& p_map, float radius_m) const {
  return fixed_->has_surface_within(p_map, radius_m) ||
         (moving_ && moving_->has_surface_within(p_map, radius_m));
}

}  // namespace fleetloc
