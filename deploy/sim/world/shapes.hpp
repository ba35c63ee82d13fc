#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "deploy/sim/world/mesh.hpp"
#include "deploy/sim/world/surface.hpp"

namespace fleetloc {

/// An object of the world, composed of simple shapes in its own frame. The mesh is in map; its
/// surfaces count those of this object.
struct SceneObject {
  Placement placement;
  Mesh mesh;
  std::vector<Surface> surfaces;
};

/// @return the index of the new surface, whose texture is fixed in the object's frame
std::uint32_t add_surface(SceneObject& object, Pattern pattern, float albedo, std::uint32_t seed);

/// A quadrilateral; corners in the object's frame, in their order around it [m].
void add_quad(SceneObject& object,
              const std::array<Eigen::Vector3f, 4>& corners,
              std::uint32_t surface);

/// A box along the axes of the object's frame [m].
void add_box(SceneObject& object,
             const Eigen::Vector3f& center,
             const Eigen::Vector3f& size,
             std::uint32_t surface);

/// A tapering rod; `radii_m` at its two ends.
struct Rod {
  Eigen::Vector3f from;
  Eigen::Vector3f to;
  std::array<float, 2> radii_m;
  int sides = 6;
};
void add_rod(SceneObject& object, const Rod& rod, std::uint32_t surface);

/// Appends `object` to a mesh and its surfaces to the mesh's.
void append(const SceneObject& object, Mesh& mesh, std::vector<Surface>& surfaces);

}  // namespace fleetloc
