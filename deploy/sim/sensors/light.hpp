#pragma once

#include <cstdint>

#include "deploy/sim/world/ray_caster.hpp"
#include "deploy/sim/world/season_scene.hpp"

namespace fleetloc {

/// The sun's disc is taken as so many points, each pixel and its neighbours on either side see
/// another one. A soft shadow is the mean over them.
inline constexpr int kSunParts = 3;

/// Rays of pixels.
struct ViewPacket {
  RayPacket rays;
  RayPacket::Lanes<std::uint8_t> sun_part;  ///< in [0, kSunParts)
  float pixel_rad;                          ///< width of a pixel
};

/// What the rays of a packet see.
struct ShadedPacket {
  RayPacket::Lanes<float> radiance;  ///< by the light of the sky alone
  RayPacket::Lanes<float> sun;       ///< that adds to it where the sun shines
  /// The surface, in the upper 16 bits, and which way it faces there; for finding edges. All
  /// leaves have one key, the sky has another; zero in unused lanes.
  RayPacket::Lanes<std::uint32_t> key;
};

/// Light and air of a season.
struct Light {
  Eigen::Vector3f to_sun_map;    ///< unit length; across it are
  Eigen::Vector3f sun_left_map;  ///< and
  Eigen::Vector3f sun_up_map;
  float sun;
  float ambient;
  float haze_m;
  float snow;
};

Light light_of(const SeasonScene& scene);

/// Sky, haze, and what the sun would add.
ShadedPacket shade(const SceneView& view,
                   const Light& light,
                   const ViewPacket& packet,
                   const HitPacket& hits);

/// Bit i is set where nothing hides the packet's part of the sun from what ray i meets.
std::uint32_t sunlit(const SceneView& view,
                     const Light& light,
                     const ViewPacket& packet,
                     const HitPacket& hits);

}  // namespace fleetloc
