#include "shared/world/packet_triangle.hpp"

#include <cstddef>

#include <Eigen/Geometry>

#include "shared/core/float4.hpp"

namespace fleetloc {

void meet_triangle(const std::array<Eigen::Vector3f, 3>& corners,
                   const TriangleIdentity& identity,
                   const RayPacket& rays,
                   HitPacket& hits) {
  const Eigen::Vector3f a = corners[1] - corners[0];
  const Eigen::Vector3f b = corners[2] - corners[0];
  const Eigen::Vector3f n = a.cross(b);
  const Eigen::Vector3f unit = n.normalized();
  const auto dot = [](const Eigen::Vector3f& v, const std::array<Float4, 3>& w) {
    return v.x() * w[0] + v.y() * w[1] + v.z() * w[2];
  };
  for (std::size_t i = 0; i < RayPacket::kSize; i += 4) {
    const std::array<Float4, 3> d = {
        load4(&rays.direction_x[i]), load4(&rays.direction_y[i]), load4(&rays.direction_z[i])};
    const std::array<Float4, 3> way = {corners[0].x() - load4(&rays.origin_x[i]),
                                       corners[0].y() - load4(&rays.origin_y[i]),
                                       corners[0].z() - load4(&rays.origin_z[i])};
    const std::array<Float4, 3> moment = {way[1] * d[2] - way[2] * d[1],
                                          way[2] * d[0] - way[0] * d[2],
                                          way[0] * d[1] - way[1] * d[0]};
    const Float4 along = dot(n, d);
    const Float4 share_a = dot(b, moment) / along;
    const Float4 share_b = -dot(a, moment) / along;
    const Float4 distance_m = dot(n, way) / along;
    const Float4 before = load4(&hits.distance_m[i]);
    const Int4 is_hit = (share_a >= 0.0F) & (share_b >= 0.0F) & (share_a + share_b <= 1.0F) &
                        (distance_m >= load4(&rays.least_m[i])) &
                        (distance_m <= load4(&rays.most_m[i])) & (distance_m < before);
    if (!any(is_hit)) continue;
    const Float4 side = along > 0.0F ? all4(-1.0F) : all4(1.0F);
    const auto keep = [&](const auto& value, auto* to) { store4(is_hit ? value : load4(to), to); };
    keep(distance_m, &hits.distance_m[i]);
    keep(side * unit.x(), &hits.normal_x[i]);
    keep(side * unit.y(), &hits.normal_y[i]);
    keep(side * unit.z(), &hits.normal_z[i]);
    keep(Uint4{} + identity.surface, &hits.surface[i]);
    keep(Uint4{} + identity.triangle, &hits.triangle[i]);
  }
}

}  // namespace fleetloc
