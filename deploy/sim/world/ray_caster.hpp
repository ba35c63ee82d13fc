#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "deploy/sim/world/mesh.hpp"
#include "deploy/sim/world/ray_packet.hpp"

namespace fleetloc {

class TriangleTree;

/// First hits and occlusion of rays in a triangle mesh, by Embree. Immutable, thread-safe, and with
/// the same results in every run. Copies share the triangles.
class RayCaster {
 public:
  /// Throws std::invalid_argument for an index out of range or a number that is not finite, and
  /// std::runtime_error if Embree fails.
  explicit RayCaster(const Mesh& fixed);

  /// The same triangles and those of `moving` at one instant: cheap while these are few.
  [[nodiscard]] RayCaster with(const Mesh& moving) const;

  /// Nothing if there is no triangle within `max_m`.
  [[nodiscard]] std::optional<Hit> first_hit(const Ray& ray, float max_m) const;

  [[nodiscard]] HitPacket first_hits(const RayPacket& rays) const;

  /// The same, but a ray that hits one of `triangles` is not tested against the rest, so that
  /// occluders in front of it are missed. Cheap where most rays hit one.
  [[nodiscard]] HitPacket first_hits_on(std::span<const std::uint32_t> triangles,
                                        const RayPacket& rays) const;

  /// First hits on two candidate triangles per ray (or HitPacket::kNoTriangle) alone.
  using TrianglePairs = std::array<RayPacket::Lanes<std::uint32_t>, 2>;
  [[nodiscard]] HitPacket first_hits_on_pairs(const TrianglePairs& triangles,
                                              const RayPacket& rays) const;

  /// Whether a triangle lies between two points; surfaces within 2 mm of either do not count.
  [[nodiscard]] bool occluded(const Eigen::Vector3f& from_map, const Eigen::Vector3f& to_map) const;

  /// Bit i is set if ray i of the packet hits a triangle between its min_m and max_m.
  [[nodiscard]] std::uint32_t occluded(const RayPacket& rays) const;

  /// Whether a triangle lies within `radius_m` of the point.
  [[nodiscard]] bool has_surface_within(const Eigen::Vector3f& p_map, float radius_m) const;

 private:
  RayCaster() = default;

  [[nodiscard]] std::array<Eigen::Vector3f, 3> corners(std::uint32_t triangle) const;
  [[nodiscard]] std::uint32_t surface(std::uint32_t triangle) const;
  /// Traces the rays that have no hit yet.
  void trace_rest(const RayPacket& rays, HitPacket& hits) const;

  std::shared_ptr<const TriangleTree> fixed_;
  std::shared_ptr<const TriangleTree> moving_;  // may be null
};

}  // namespace fleetloc
