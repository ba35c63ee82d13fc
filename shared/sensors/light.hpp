#pragma once

#include <cstdint>

#include "shared/world/ray_caster.hpp"
#include "shared/world/session_scene.hpp"

namespace fleetloc {

/// The sun's disc is taken as so many points. A pixel sees one of them, its neighbours the others,
/// so that a soft shadow is an edge everywhere, and an edge gets all of them.
inline constexpr int kSunParts = 3;

/// Rays of pixels.
struct ViewPacket {
  RayPacket rays;
  RayPacket::Lanes<std::uint8_t> sun_part;  ///< in [0, kSunParts)
  float pixel_rad;                          ///< width of a pixel
};

/// What the rays of a packet see.
struct SeenPacket {
  RayPacket::Lanes<float> radiance;
  /// Differs, with few exceptions, where two pixels see different things, sides of a thing, or sun
  /// and shadow; for finding edges.
  RayPacket::Lanes<std::uint32_t> key;
};

/// Light and air of a session.
struct Light {
  Eigen::Vector3f to_sun_map;    ///< unit length; across it are
  Eigen::Vector3f sun_left_map;  ///< and
  Eigen::Vector3f sun_up_map;
  float sun;
  float ambient;
  float haze_m;
  float snow;
};

Light light_of(const SessionScene& scene);

/// Sun with a soft shadow, light of the sky, haze.
SeenPacket see(const SceneView& view, const Light& light, const ViewPacket& packet);

}  // namespace fleetloc
