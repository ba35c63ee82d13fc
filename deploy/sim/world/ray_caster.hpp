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

/// What a ray meets first in a set of triangles. Immutable: any number of threads may ask at once,
/// and the same question has the same answer in every run. Copies share the triangles.
class RayCaster {
 public:
  /// Throws std::invalid_argument for an index out of range or a number that is not finite, and
  /// std::runtime_error if Embree fails.
  explicit RayCaster(const Mesh& fixed);

  /// The same triangles and `moving`, where they are at one instant: cheap while those are few.
  [[nodiscard]] RayCaster with(const Mesh& moving) const;

  /// Nothing if there is no triangle within `max_m`.
  [[nodiscard]] std::optional<Hit> first_hit(const Ray& ray, float max_m) const;

  [[nodiscard]] HitPacket first_hits(const RayPacket& rays) const;

  /// The same, but what lies before or beside these triangles is seen only by the rays that meet
  /// none of them. Cheap where most meet one.
  [[nodiscard]] HitPacket first_hits_on(std::span<const std::uint32_t> triangles,
                                        const RayPacket& rays) const;

  /// The nearer one of two triangles of each ray's own (or HitPacket::kNoTriangle), if it meets
  /// one.
  using TrianglePairs = std::array<RayPacket::Lanes<std::uint32_t>, 2>;
  [[nodiscard]] HitPacket hits_on_own(const TrianglePairs& triangles, const RayPacket& rays) const;

  /// Something stands between two points; the surfaces that they lie on do not count (2 mm).
  [[nodiscard]] bool occluded(const Eigen::Vector3f& from_map, const Eigen::Vector3f& to_map) const;

  /// Bit i is set where ray i of the packet meets something between its min_m and max_m.
  [[nodiscard]] std::uint32_t occluded(const RayPacket& rays) const;

  /// Some triangle comes as near as `radius_m` to the point.
  [[nodiscard]] bool has_surface_within(const Eigen::Vector3f& p_map, float radius_m) const;

 private:
  RayCaster() = default;

  [[nodiscard]] std::array<Eigen::Vector3f, 3> corners(std::uint32_t triangle) const;
  [[nodiscard]] std::uint32_t surface(std::uint32_t triangle) const;
  /// Of the rays that have no hit yet.
  void trace_rest(const RayPacket& rays, HitPacket& hits) const;

  std::shared_ptr<const TriangleTree> fixed_;
  std::shared_ptr<const TriangleTree> moving_;  // may be null
};

}  // namespace fleetloc
