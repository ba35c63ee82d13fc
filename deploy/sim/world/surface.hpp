#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

#include "deploy/sim/world/float4.hpp"

namespace fleetloc {

/// Patterns; see surface.cpp for what they are made of.
enum class Pattern : std::uint8_t {
  kGravel,
  kSlabs,
  kGrass,
  kPlaster,
  kBrick,
  kPanels,
  kRoof,
  kGlass,
  kTrim,
  kBark,
  kLeaves,
  kPaint,
  kPoster,
  kTarp,
  kSnow,
  kCloth,
};

/// Position and heading of an object: its frame is z up, its x axis is turned by yaw from map's.
struct Placement {
  Eigen::Vector3f p_map = Eigen::Vector3f::Zero();
  float yaw_rad = 0.0F;

  [[nodiscard]] Eigen::Vector3f to_map(const Eigen::Vector3f& p_local) const;
};

/// Appearance of a triangle: a solid texture, fixed in the object's own frame, of gray albedo.
struct Surface {
  Pattern pattern = Pattern::kPlaster;
  float albedo = 0.4F;  ///< mean
  std::uint32_t seed = 0;
  bool is_thin = false;    ///< translucent, as leaves
  bool takes_snow = true;  ///< where it faces up
  Placement frame;         ///< of the texture
  float cos_yaw = 1.0F;    ///< of the frame
  float sin_yaw = 0.0F;
};

Surface make_surface(Pattern pattern, float albedo, std::uint32_t seed, const Placement& frame);

/// Four surface points to be shaded, one for each pixel.
struct ShadingPoints {
  std::array<Float4, 3> p_map;
  std::array<Float4, 3> normal_map;     ///< unit, towards the camera
  std::array<Float4, 3> direction_map;  ///< unit, from the camera
  Float4 pixel_m;                       ///< width of the pixel at the point, across the ray
};

/// In (0, 1). Detail finer than the pixel's footprint on the surface is filtered out
/// (antialiasing); edges between cells are as wide as the footprint.
Float4 albedo(const Surface& surface, const ShadingPoints& seen);

/// Share in [0, 1] of the pixel that lies under snow when `cover` of the level ground does.
Float4 snow_share(const ShadingPoints& seen, float cover);

/// In [0, 1], smooth over a length of 1; for relief and the like.
Float4 smooth_noise(const Float4& x, const Float4& y, std::uint32_t seed);
float smooth_noise(float x, float y, std::uint32_t seed);

}  // namespace fleetloc
