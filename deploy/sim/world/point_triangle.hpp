#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace fleetloc {

/// The point of a triangle, its border included, that is nearest to `p`.
inline Eigen::Vector3f nearest_point_of_triangle(const Eigen::Vector3f& p,
                                                 const std::array<Eigen::Vector3f, 3>& corners) {
  const Eigen::Vector3f normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  const float squared = normal.squaredNorm();
  bool inside = squared > 0.0F;
  for (std::size_t i = 0; i < 3 && inside; ++i) {
    const Eigen::Vector3f edge = corners[(i + 1) % 3] - corners[i];
    inside = edge.cross(p - corners[i]).dot(normal) >= 0.0F;
  }
  if (inside) return p - normal * ((p - corners[0]).dot(normal) / squared);
  Eigen::Vector3f nearest = corners[0];
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Vector3f edge = corners[(i + 1) % 3] - corners[i];
    const float length = edge.squaredNorm();
    const float share = length > 0.0F ? (p - corners[i]).dot(edge) / length : 0.0F;
    const Eigen::Vector3f candidate = corners[i] + std::clamp(share, 0.0F, 1.0F) * edge;
    if ((candidate - p).squaredNorm() < (nearest - p).squaredNorm()) nearest = candidate;
  }
  return nearest;
}

}  // namespace fleetloc
