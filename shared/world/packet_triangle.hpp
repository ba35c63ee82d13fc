#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

#include "shared/world/ray_caster.hpp"

namespace fleetloc {

/// Of a triangle, as its hits name it.
struct TriangleIdentity {
  std::uint32_t triangle;
  std::uint32_t surface;
};

/// Rays against one triangle (Moller and Trumbore, 1997); keeps what is nearer than the hits.
void meet_triangle(const std::array<Eigen::Vector3f, 3>& corners,
                   const TriangleIdentity& identity,
                   const RayPacket& rays,
                   HitPacket& hits);

}  // namespace fleetloc
