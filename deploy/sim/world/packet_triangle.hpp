#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

#include "deploy/sim/world/ray_packet.hpp"

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

/// One triangle for each ray of a packet. A lane that is not set is met by no ray.
struct OwnTriangles {
  void set(std::size_t lane,
           const std::array<Eigen::Vector3f, 3>& corners,
           std::uint32_t its_surface);

  std::array<RayPacket::Lanes<float>, 3> first{};  ///< corner
  std::array<RayPacket::Lanes<float>, 3> a{};      ///< sides from there
  std::array<RayPacket::Lanes<float>, 3> b{};
  RayPacket::Lanes<std::uint32_t> triangle{};
  RayPacket::Lanes<std::uint32_t> surface{};
};

/// Each ray against its own triangle; keeps what is nearer than the hits.
void meet_own_triangles(const OwnTriangles& own, const RayPacket& rays, HitPacket& hits);

}  // namespace fleetloc
