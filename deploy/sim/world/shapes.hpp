#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "deploy/sim/world/mesh.hpp"
#include "deploy/sim/world/surface.hpp"

namespace fleetloc {

/// A thing of the world, put together from simple shapes in its own frame. The mesh is in map; its
/// surfaces count those of this thing.
struct Thing {
  Placement placement;
  Mesh mesh;
  std::vector<Surface> surfaces;
};

/// @return the index of the new surface, whose texture is fixed in the thing's frame
std::uint32_t add_surface(Thing& thing, Pattern pattern, float albedo, std::uint32_t seed);

/// Corners in the thing's frame, around the face.
void add_quad(Thing& thing, const std::array<Eigen::Vector3f, 4>& corners, std::uint32_t surface);

/// Upright in the thing's frame.
void add_box(Thing& thing,
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
void add_rod(Thing& thing, const Rod& rod, std::uint32_t surface);

/// Appends `thing` to a mesh and its surfaces to the mesh's.
void append(const Thing& thing, Mesh& mesh, std::vector<Surface>& surfaces);

}  // namespace fleetloc
