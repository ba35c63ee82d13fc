#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace fleetloc {

/// Triangles in the frame `map` [m]. Both sides are hit by rays. Single precision holds 0.1 mm up
/// to 1 km from the origin.
struct Mesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices of vertices
  std::vector<std::uint32_t> surfaces;                  ///< of each triangle: index of its surface
};

}  // namespace fleetloc
