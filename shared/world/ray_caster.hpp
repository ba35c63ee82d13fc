#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "shared/world/mesh.hpp"

namespace fleetloc {

struct Ray {
  Eigen::Vector3f origin_map;
  Eigen::Vector3f direction_map;  ///< unit length
};

struct Hit {
  float distance_m = 0.0F;
  Eigen::Vector3f normal_map;  ///< of the triangle, unit length, towards the ray's origin
  std::uint32_t surface = 0;   ///< of the triangle
};

/// Rays side by side, for those that go nearly the same way. Unused lanes have `most_m` < 0.
struct alignas(64) RayPacket {
  static constexpr int kSize = 16;
  template <typename T>
  using Lanes = std::array<T, kSize>;

  Lanes<float> origin_x, origin_y, origin_z;           ///< in map
  Lanes<float> direction_x, direction_y, direction_z;  ///< in map, unit length
  Lanes<float> least_m;
  Lanes<float> most_m;
};

struct alignas(64) HitPacket {
  static constexpr float kNone = std::numeric_limits<float>::infinity();

  RayPacket::Lanes<float> distance_m;  ///< kNone where nothing was hit; then the rest is undefined
  RayPacket::Lanes<float> normal_x, normal_y, normal_z;  ///< as in Hit
  RayPacket::Lanes<std::uint32_t> surface;
  RayPacket::Lanes<std::uint32_t> triangle;  ///< its number in this caster
};

/// What a ray meets first in a set of triangles. Immutable: any number of threads may ask at once,
/// and the same question has the same answer in every run. Copies share the triangles.
class RayCaster {
 public:
  /// Throws std::invalid_argument for an index out of range or a number that is not finite, and
  /// std::runtime_error if Embree fails.
  explicit RayCaster(const Mesh& fixed);

  /// The same triangles and `moving`, where they are at one instant: cheap while those are few.
  [[nodiscard]] RayCaster with(const Mesh& moving) const;

  /// Nothing if there is no triangle within `most_m`.
  [[nodiscard]] std::optional<Hit> first_hit(const Ray& ray, float most_m) const;

  [[nodiscard]] HitPacket first_hits(const RayPacket& rays) const;

  /// The same, but what lies before or beside these triangles is seen only by the rays that meet
  /// none of them. Cheap where most meet one.
  [[nodiscard]] HitPacket first_hits_on(std::span<const std::uint32_t> triangles,
                                        const RayPacket& rays) const;

  /// Something stands between two points; the surfaces that they lie on do not count (2 mm).
  [[nodiscard]] bool occluded(const Eigen::Vector3f& from_map, const Eigen::Vector3f& to_map) const;

  /// Bit i is set where ray i of the packet meets something between its least_m and most_m.
  [[nodiscard]] std::uint32_t occluded(const RayPacket& rays) const;

  /// Some triangle comes as near as `radius_m` to the point.
  [[nodiscard]] bool has_surface_within(const Eigen::Vector3f& p_map, float radius_m) const;

 private:
  struct Triangles;

  RayCaster() = default;

  void trace(const RayPacket& rays, HitPacket& hits) const;

  std::shared_ptr<const Triangles> fixed_;
  std::shared_ptr<const Triangles> moving_;  // may be null
};

}  // namespace fleetloc
