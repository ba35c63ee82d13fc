#include "deploy/sim/sensors/light.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <Eigen/Geometry>

namespace fleetloc {
namespace {

constexpr float kFarthestShadow_m = 400.0F;
constexpr float kSunRadius_rad = 0.008F;  // a little larger than it is: softer
constexpr float kShadowSkin_m = 0.01F;
constexpr float kSnowAlbedo = 0.78F;
constexpr float kThrough = 0.45F;  // share of sunlight that a leaf transmits
constexpr std::uint32_t kSkyKey = 0xffffffffU;
constexpr std::uint32_t kLeafKey = 0xfffffffeU;  // edges between leaves are not worth the time

/// A direction in coarse steps, in 16 bits: triangles of one plane have the same.
Uint4 facing(const std::array<Float4, 3>& direction) {
  const auto step = [](const Float4& value) {
    return to_unsigned(to_integer(3.0F * value + 8.5F));
  };
  return (step(direction[0]) * 31U + step(direction[1])) * 31U + step(direction[2]);
}

/// Direction of a sample of the sun's disc.
Eigen::Vector3f towards_sun(const Light& light, std::uint8_t part) {
  constexpr std::array<std::array<float, 2>, kSunSamples> kParts = {
      {{0.0F, 0.66F}, {0.57F, -0.33F}, {-0.57F, -0.33F}}};
  const auto& xy = kParts.at(std::size_t{part} % kParts.size());
  return light.to_sun_map +
         kSunRadius_rad * (xy[0] * light.sun_left_map + xy[1] * light.sun_up_map);
}

Float4 sky(const std::array<Float4, 3>& direction, const Light& light) {
  const Float4 up = max4(direction[2], all4(0.0F));
  const Float4 per_height = 3.0F / (up + 0.3F);
  const Float4 clouds = smooth_noise(direction[0] * per_height, direction[1] * per_height, 7U);
  const Float4 clear = 1.25F * light.ambient * (1.0F - 0.35F * up) + 0.15F * light.sun;
  return clear * (0.92F + 0.16F * clouds);
}

void set_lane(RayPacket& rays,
              std::size_t i,
              const Eigen::Vector3f& origin,
              const Eigen::Vector3f& direction) {
  rays.origin_x[i] = origin.x();
  rays.origin_y[i] = origin.y();
  rays.origin_z[i] = origin.z();
  rays.direction_x[i] = direction.x();
  rays.direction_y[i] = direction.y();
  rays.direction_z[i] = direction.z();
  rays.min_m[i] = 0.0F;
  rays.max_m[i] = kFarthestShadow_m;
}

/// Irradiance by the sun, by the cosine of its angle to the normal.
float taken(const Surface& surface, float along) {
  return std::max(along, surface.is_thin ? -kThrough * along : 0.0F);
}

Float4 snowy_albedo(const Surface& surface, const ShadingPoints& seen, const Light& light) {
  static const Surface snow = make_surface(Pattern::kSnow, kSnowAlbedo, 1U, {});
  const Float4 share = surface.takes_snow ? snow_share(seen, light.snow) : all4(0.0F);
  const Float4 bare = any(share < 1.0F) ? albedo(surface, seen) : all4(0.0F);
  if (!any(share > 0.0F)) return bare;
  return (1.0F - share) * bare + share * albedo(snow, seen);
}

/// Reflection of the surfaces.
struct Shading {
  Float4 albedo;
  Float4 taken;  ///< of the sun
  Int4 is_thin;
};

/// Four hits; lanes without are undefined.
Shading shaded(const SceneView& view,
               const Light& light,
               const ShadingPoints& seen,
               const HitPacket& hits,
               std::size_t first) {
  const Uint4 surfaces = load4(&hits.surface[first]);
  const auto& n = seen.normal_map;
  const Float4 along =
      n[0] * light.to_sun_map.x() + n[1] * light.to_sun_map.y() + n[2] * light.to_sun_map.z();
  Shading shading{};
  Int4 is_done{};
  for (std::size_t i = 0; i < 4; ++i) {
    if (is_done[i] != 0 || hits.distance_m[first + i] == HitPacket::kNone) continue;
    const Surface& surface = view.surfaces[hits.surface[first + i]];
    const Int4 is_same = surfaces == hits.surface[first + i];
    shading.albedo = is_same ? snowy_albedo(surface, seen, light) : shading.albedo;
    shading.is_thin |= is_same & (surface.is_thin ? ~Int4{} : Int4{});
    is_done |= is_same;
  }
  shading.taken = max4(along, shading.is_thin ? -kThrough * along : all4(0.0F));
  return shading;
}

/// Four lanes of a ShadedPacket.
struct Seen4 {
  Float4 radiance;
  Float4 sun;
  Uint4 key;
};

std::array<Float4, 3> directions(const RayPacket& rays, std::size_t first) {
  return {load4(&rays.direction_x[first]),
          load4(&rays.direction_y[first]),
          load4(&rays.direction_z[first])};
}

Seen4 seen_sky(const Light& light, const ViewPacket& packet, std::size_t first) {
  return {.radiance = sky(directions(packet.rays, first), light),
          .sun = all4(0.0F),
          .key = Uint4{} + kSkyKey};
}

/// Lanes without a hit are undefined.
Seen4 seen_surfaces(const SceneView& view,
                    const Light& light,
                    const ViewPacket& packet,
                    const HitPacket& hits,
                    std::size_t first) {
  const RayPacket& rays = packet.rays;
  const auto direction = directions(rays, first);
  const Float4 distance_or_none = load4(&hits.distance_m[first]);
  const Float4 distance_m = distance_or_none < HitPacket::kNone ? distance_or_none : all4(0.0F);
  const ShadingPoints points = {.p_map = {load4(&rays.origin_x[first]) + distance_m * direction[0],
                                          load4(&rays.origin_y[first]) + distance_m * direction[1],
                                          load4(&rays.origin_z[first]) + distance_m * direction[2]},
                                .normal_map = {load4(&hits.normal_x[first]),
                                               load4(&hits.normal_y[first]),
                                               load4(&hits.normal_z[first])},
                                .direction_map = direction,
                                .pixel_m = distance_m * packet.pixel_rad};
  const Shading shading = shaded(view, light, points, hits, first);
  const float air = 1.2F * light.ambient + 0.15F * light.sun;
  const Float4 from_sky = light.ambient * (0.7F + 0.3F * points.normal_map[2]);
  const Float4 clear = exponential(-distance_m / light.haze_m);
  const Uint4 side_key = (load4(&hits.surface[first]) << 16U) | facing(points.normal_map);
  return {.radiance = clear * shading.albedo * from_sky + (1.0F - clear) * air,
          .sun = clear * shading.albedo * light.sun * shading.taken,
          .key = shading.is_thin ? Uint4{} + kLeafKey : side_key};
}

}  // namespace

Light light_of(const SeasonScene& scene) {
  const SeasonConfig& config = scene.config();
  const Eigen::Vector3f& to_sun = scene.to_sun();
  const Eigen::Vector3f left = to_sun.unitOrthogonal();
  return {.to_sun_map = to_sun,
          .sun_left_map = left,
          .sun_up_map = to_sun.cross(left),
          .sun = config.sun,
          .ambient = config.ambient,
          .haze_m = config.haze_m,
          .snow = config.snow};
}

ShadedPacket shade(const SceneView& view,
                   const Light& light,
                   const ViewPacket& packet,
                   const HitPacket& hits) {
  const RayPacket& rays = packet.rays;
  ShadedPacket seen{};
  for (std::size_t first = 0; first < RayPacket::kSize; first += 4) {
    const Int4 is_hit = load4(&hits.distance_m[first]) < HitPacket::kNone;
    const Seen4 far = any(~is_hit) ? seen_sky(light, packet, first) : Seen4{};
    const Seen4 near = any(is_hit) ? seen_surfaces(view, light, packet, hits, first) : Seen4{};
    const Int4 is_used = load4(&rays.max_m[first]) >= 0.0F;
    const Float4 radiance = is_hit ? near.radiance : far.radiance;
    const Uint4 key = is_hit ? near.key : far.key;
    store4(is_used ? radiance : all4(0.0F), &seen.radiance[first]);
    store4(is_hit ? near.sun : all4(0.0F), &seen.sun[first]);
    store4(is_used ? key : Uint4{}, &seen.key[first]);
  }
  return seen;
}

std::uint32_t sunlit(const SceneView& view,
                     const Light& light,
                     const ViewPacket& packet,
                     const HitPacket& hits) {
  const RayPacket& rays = packet.rays;
  RayPacket sun_rays{};
  sun_rays.max_m.fill(-1.0F);
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < RayPacket::kSize; ++i) {
    if (hits.distance_m[i] == HitPacket::kNone) continue;
    const Eigen::Vector3f normal(hits.normal_x[i], hits.normal_y[i], hits.normal_z[i]);
    const float along = normal.dot(light.to_sun_map);
    if (taken(view.surfaces[hits.surface[i]], along) <= 0.0F) continue;
    const Eigen::Vector3f origin(rays.origin_x[i], rays.origin_y[i], rays.origin_z[i]);
    const Eigen::Vector3f direction(rays.direction_x[i], rays.direction_y[i], rays.direction_z[i]);
    const float side = along > 0.0F ? kShadowSkin_m : -kShadowSkin_m;
    set_lane(sun_rays,
             i,
             origin + hits.distance_m[i] * direction + side * normal,
             towards_sun(light, packet.sun_sample[i]));
    bits |= 1U << i;
  }
  return bits & ~view.caster.occluded(sun_rays);
}

}  // namespace fleetloc
