#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include <Eigen/Core>

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

/// A packet of coherent rays. Unused lanes have `max_m` < 0.
struct alignas(64) RayPacket {
  static constexpr int kSize = 16;
  template <typename T>
  using Lanes = std::array<T, kSize>;

  Lanes<float> origin_x, origin_y, origin_z;           ///< in map
  Lanes<float> direction_x, direction_y, direction_z;  ///< in map, unit length
  Lanes<float> min_m;
  Lanes<float> max_m;
};

struct alignas(64) HitPacket {
  static constexpr float kNone = std::numeric_limits<float>::infinity();
  static constexpr std::uint32_t kNoTriangle = std::numeric_limits<std::uint32_t>::max();

  RayPacket::Lanes<float> distance_m;  ///< kNone where nothing was hit; then the rest is undefined
  RayPacket::Lanes<float> normal_x, normal_y, normal_z;  ///< as in Hit
  RayPacket::Lanes<std::uint32_t> surface;
  RayPacket::Lanes<std::uint32_t> triangle;  ///< its index in this caster
};

}  // namespace fleetloc
