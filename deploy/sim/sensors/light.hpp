#pragma once

#include <cstdint>

#include "deploy/sim/world/ray_caster.hpp"
#include "deploy/sim/world/season_scene.hpp"

namespace fleetloc {

/// Sample points of the sun's disc. Neighbouring pixels cast shadow rays to different ones; a soft
/// shadow is the mean over them.
inline constexpr int kSunSamples = 3;

/// Rays through pixels.
struct ViewPacket {
  RayPacket rays;
  RayPacket::Lanes<std::uint8_t> sun_sample;  ///< in [0, kSunSamples)
  float pixel_rad;                            ///< width of a pixel
};

/// Shading of the hits of a packet.
struct ShadedPacket {
  RayPacket::Lanes<float> radiance;  ///< by ambient light alone
  RayPacket::Lanes<float> sun;       ///< added where the point is sunlit
  /// The surface, in the upper 16 bits, and its coarse normal; for edge detection. All leaves have
  /// one key, the sky has another; zero in unused lanes.
  RayPacket::Lanes<std::uint32_t> key;
};

/// Light and air of a season.
struct Light {
  Eigen::Vector3f to_sun_map;  ///< unit vector, orthogonal to the next two
  Eigen::Vector3f sun_left_map;
  Eigen::Vector3f sun_up_map;
  float sun;
  float ambient;
  float haze_m;
  float snow;
};

Light light_of(const SeasonScene& scene);

/// Radiance with sky and haze, and what the sun would add; without shadows.
ShadedPacket shade(const SceneView& view,
                   const Light& light,
                   const ViewPacket& packet,
                   const HitPacket& hits);

/// Shadow rays: bit i is set if the sun's sample is visible from the hit of ray i.
std::uint32_t sunlit(const SceneView& view,
                     const Light& light,
                     const ViewPacket& packet,
                     const HitPacket& hits);

}  // namespace fleetloc
