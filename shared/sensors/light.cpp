#include "shared/sensors/light.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <Eigen/Geometry>

namespace fleetloc {
namespace {

constexpr float kFarthest_m = 400.0F;
constexpr float kSunRadius_rad = 0.008F;  // a little larger than it is: softer
constexpr float kShadowSkin_m = 0.01F;
constexpr float kSnowAlbedo = 0.78F;
constexpr float kThrough = 0.45F;  // share of the sun that shines through a leaf
constexpr std::uint32_t kSkyKey = 0xffffffffU;
constexpr std::uint32_t kLeafKey = 0xfffffffeU;  // edges between leaves are not worth the time

std::uint32_t mixed(std::uint32_t h) {
  h ^= h >> 16U;
  h *= 0x7feb352dU;
  h ^= h >> 15U;
  h *= 0x846ca68bU;
  return h ^ (h >> 16U);
}

/// A direction in coarse steps: triangles of one plane have the same.
std::uint32_t facing(float x, float y, float z) {
  const auto step = [](float value) { return static_cast<std::uint32_t>(3.0F * value + 8.5F); };
  return (step(x) * 31U + step(y)) * 31U + step(z);
}

/// A point of the sun's disc.
Eigen::Vector3f towards_sun(const Light& light, std::uint8_t part) {
  constexpr std::array<std::array<float, 2>, kSunParts> kParts = {
      {{0.0F, 0.66F}, {0.57F, -0.33F}, {-0.57F, -0.33F}}};
  const auto& xy = kParts.at(part % kSunParts);
  return light.to_sun_map +
         kSunRadius_rad * (xy[0] * light.sun_left_map + xy[1] * light.sun_up_map);
}

float sky(const Eigen::Vector3f& direction, const Light& light) {
  const float up = std::max(direction.z(), 0.0F);
  const float clouds =
      smooth_noise(3.0F * direction.x() / (up + 0.3F), 3.0F * direction.y() / (up + 0.3F), 7U);
  const float clear = 1.25F * light.ambient * (1.0F - 0.35F * up) + 0.15F * light.sun;
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
  rays.least_m[i] = 0.0F;
  rays.most_m[i] = kFarthest_m;
}

float snowy_albedo(const Surface& surface, const SeenPoint& seen, const Light& light) {
  static const Surface snow = make_surface(Pattern::kSnow, kSnowAlbedo, 1U, {});
  const float share = surface.takes_snow ? snow_share(seen, light.snow) : 0.0F;
  const float bare = share < 1.0F ? albedo(surface, seen) : 0.0F;
  return share > 0.0F ? (1.0F - share) * bare + share * albedo(snow, seen) : bare;
}

SeenPoint point_of(const RayPacket& rays, const HitPacket& hits, std::size_t i) {
  SeenPoint point;
  point.direction_map = {rays.direction_x[i], rays.direction_y[i], rays.direction_z[i]};
  point.normal_map = {hits.normal_x[i], hits.normal_y[i], hits.normal_z[i]};
  point.p_map = Eigen::Vector3f(rays.origin_x[i], rays.origin_y[i], rays.origin_z[i]) +
                hits.distance_m[i] * point.direction_map;
  return point;
}

/// What a lane's surface does with light.
struct Shading {
  RayPacket::Lanes<float> albedo{};
  RayPacket::Lanes<float> sun{};  ///< that it takes of the sun: 0 where that does not reach it
};

Shading shaded(const SceneView& view,
               const Light& light,
               const ViewPacket& packet,
               const HitPacket& hits) {
  Shading shading;
  RayPacket sun_rays{};
  sun_rays.most_m.fill(-1.0F);
  for (std::size_t i = 0; i < RayPacket::kSize; ++i) {
    if (hits.distance_m[i] == HitPacket::kNone) continue;
    SeenPoint point = point_of(packet.rays, hits, i);
    point.pixel_m = hits.distance_m[i] * packet.pixel_rad;
    const Surface& surface = view.surfaces[hits.surface[i]];
    shading.albedo[i] = snowy_albedo(surface, point, light);
    const float along = point.normal_map.dot(light.to_sun_map);
    const float through = surface.is_thin ? -kThrough * along : 0.0F;
    shading.sun[i] = light.sun * std::max(along, through);
    if (shading.sun[i] <= 0.0F) continue;
    const float side = along > 0.0F ? kShadowSkin_m : -kShadowSkin_m;
    const Eigen::Vector3f from = point.p_map + side * point.normal_map;
    set_lane(sun_rays, i, from, towards_sun(light, packet.sun_part[i]));
  }
  const std::uint32_t shadow = view.caster.occluded(sun_rays);
  for (std::size_t i = 0; i < RayPacket::kSize; ++i) {
    const bool is_dark = ((shadow >> i) & 1U) != 0U || shading.sun[i] < 0.0F;
    if (is_dark) shading.sun[i] = 0.0F;
  }
  return shading;
}

}  // namespace

Light light_of(const SessionScene& scene) {
  const SessionConfig& config = scene.config();
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

SeenPacket see(const SceneView& view, const Light& light, const ViewPacket& packet) {
  const RayPacket& rays = packet.rays;
  const HitPacket hits = view.caster.first_hits(rays);
  const Shading shading = shaded(view, light, packet, hits);
  const float air = 1.2F * light.ambient + 0.15F * light.sun;
  SeenPacket seen{};
  for (std::size_t i = 0; i < RayPacket::kSize; ++i) {
    if (rays.most_m[i] < 0.0F) continue;
    if (hits.distance_m[i] == HitPacket::kNone) {
      seen.radiance[i] =
          sky({rays.direction_x[i], rays.direction_y[i], rays.direction_z[i]}, light);
      seen.key[i] = kSkyKey;
      continue;
    }
    const float from_sky = light.ambient * (0.7F + 0.3F * hits.normal_z[i]);
    const float reflected = shading.albedo[i] * (from_sky + shading.sun[i]);
    const float clear = std::exp(-hits.distance_m[i] / light.haze_m);
    seen.radiance[i] = clear * reflected + (1.0F - clear) * air;
    const std::uint32_t side = facing(hits.normal_x[i], hits.normal_y[i], hits.normal_z[i]);
    const std::uint32_t key =
        mixed(2U * hits.surface[i] + (shading.sun[i] > 0.0F ? 1U : 0U)) ^ side;
    seen.key[i] = view.surfaces[hits.surface[i]].is_thin ? kLeafKey : key;
  }
  return seen;
}

}  // namespace fleetloc
