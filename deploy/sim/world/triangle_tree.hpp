#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "deploy/sim/world/mesh.hpp"
#include "deploy/sim/world/ray_packet.hpp"

struct RTCSceneTy;

namespace fleetloc {

/// Embree's bounding volume hierarchy over one mesh, with the surfaces of its triangles.
class TriangleTree {
 public:
  /// `mark` is a bit that is set in the indices of its triangles in hits, to tell two trees apart.
  /// Throws as RayCaster does.
  explicit TriangleTree(const Mesh& mesh, std::uint32_t mark = 0);
  ~TriangleTree();
  TriangleTree(const TriangleTree&) = delete;
  TriangleTree& operator=(const TriangleTree&) = delete;

  /// Without the mark.
  [[nodiscard]] std::array<Eigen::Vector3f, 3> corners(std::uint32_t triangle) const;
  [[nodiscard]] std::uint32_t surface(std::uint32_t triangle) const { return surfaces_[triangle]; }

  [[nodiscard]] std::optional<Hit> first_hit(const Ray& ray, float max_m) const;

  /// Hits that are nearer than those in `hits` replace them.
  void first_hits(const RayPacket& rays, HitPacket& hits) const;

  [[nodiscard]] bool occluded(const Ray& ray, float min_m, float max_m) const;
  [[nodiscard]] std::uint32_t occluded(const RayPacket& rays) const;
  [[nodiscard]] bool has_surface_within(const Eigen::Vector3f& p_map, float radius_m) const;

 private:
  void fill(const Mesh& mesh);

  RTCSceneTy* scene_ = nullptr;
  std::uint32_t mark_;
  std::vector<std::uint32_t> surfaces_;
  const float* vertices_ = nullptr;           // in Embree's memory
  const std::uint32_t* triangles_ = nullptr;  // the same
};

}  // namespace fleetloc
