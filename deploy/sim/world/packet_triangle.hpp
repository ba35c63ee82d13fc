#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

#include "deploy/sim/world/ray_packet.hpp"

namespace fleetloc {

/// The indices in a hit on a triangle.
struct TriangleIdentity {
  std::uint32_t triangle;
  std::uint32_t surface;
};

/// Intersects rays with one triangle (Moller and Trumbore, 1997); hits that are nearer than those
/// in `hits` replace them.
void intersect_triangle(const std::array<Eigen::Vector3f, 3>& corners,
                        const TriangleIdentity& identity,
                        const RayPacket& rays,
                        HitPacket& hits);

/// One triangle for each lane of a packet; none in a lane that is not set.
struct LaneTriangles {
  void set(std::size_t lane,
           const std::array<Eigen::Vector3f, 3>& corners,
           std::uint32_t its_surface);

  std::array<RayPacket::Lanes<float>, 3> first{};  ///< corner
  std::array<RayPacket::Lanes<float>, 3> a{};      ///< edges from there
  std::array<RayPacket::Lanes<float>, 3> b{};
  RayPacket::Lanes<std::uint32_t> triangle{};
  RayPacket::Lanes<std::uint32_t> surface{};
};

/// Intersects each ray with the triangle of its lane; nearer hits replace those in `hits`.
void intersect_lane_triangles(const LaneTriangles& own, const RayPacket& rays, HitPacket& hits);

}  // namespace fleetloc
