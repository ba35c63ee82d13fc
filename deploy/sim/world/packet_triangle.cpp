#include "deploy/sim/world/packet_triangle.hpp"

#include <Eigen/Geometry>

#include "deploy/sim/world/float4.hpp"

namespace fleetloc {
namespace {

using Vector4x3 = std::array<Float4, 3>;  // of four lanes

/// V is a vector of four lanes, or one that all lanes share.
template <typename V>
struct Sides {
  V first;  // corner
  V a;
  V b;
  V n;  // a x b
};

template <typename V>
Float4 dot(const V& v, const Vector4x3& w) {
  return v[0] * w[0] + v[1] * w[1] + v[2] * w[2];
}

struct Met {
  Float4 distance_m;
  Float4 side;  // 1 where the normal n is towards the ray's origin, else -1
  Int4 is_hit;
};

/// Four rays; degenerate triangles are never hit.
template <typename V>
Met met(const Sides<V>& triangle, const RayPacket& rays, const HitPacket& hits, std::size_t i) {
  const Vector4x3 d = {
      load4(&rays.direction_x[i]), load4(&rays.direction_y[i]), load4(&rays.direction_z[i])};
  const Vector4x3 way = {triangle.first[0] - load4(&rays.origin_x[i]),
                         triangle.first[1] - load4(&rays.origin_y[i]),
                         triangle.first[2] - load4(&rays.origin_z[i])};
  const Vector4x3 moment = {
      way[1] * d[2] - way[2] * d[1], way[2] * d[0] - way[0] * d[2], way[0] * d[1] - way[1] * d[0]};
  const Float4 along = dot(triangle.n, d);
  const Float4 share_a = dot(triangle.b, moment) / along;
  const Float4 share_b = -dot(triangle.a, moment) / along;
  const Float4 distance_m = dot(triangle.n, way) / along;
  return {.distance_m = distance_m,
          .side = along > 0.0F ? all4(-1.0F) : all4(1.0F),
          .is_hit = (share_a >= 0.0F) & (share_b >= 0.0F) & (share_a + share_b <= 1.0F) &
                    (distance_m >= load4(&rays.min_m[i])) & (distance_m <= load4(&rays.max_m[i])) &
                    (distance_m < load4(&hits.distance_m[i]))};
}

/// Where `is_hit`.
template <typename T>
void keep(const Int4& is_hit, const T& value, auto* to) {
  store4(is_hit ? value : load4(to), to);
}

}  // namespace

void intersect_triangle(const std::array<Eigen::Vector3f, 3>& corners,
                        const TriangleIdentity& identity,
                        const RayPacket& rays,
                        HitPacket& hits) {
  const Eigen::Vector3f a = corners[1] - corners[0];
  const Eigen::Vector3f b = corners[2] - corners[0];
  const Sides<Eigen::Vector3f> triangle{.first = corners[0], .a = a, .b = b, .n = a.cross(b)};
  const Eigen::Vector3f unit = triangle.n.normalized();
  for (std::size_t i = 0; i < RayPacket::kSize; i += 4) {
    const Met found = met(triangle, rays, hits, i);
    if (!any(found.is_hit)) continue;
    keep(found.is_hit, found.distance_m, &hits.distance_m[i]);
    keep(found.is_hit, found.side * unit.x(), &hits.normal_x[i]);
    keep(found.is_hit, found.side * unit.y(), &hits.normal_y[i]);
    keep(found.is_hit, found.side * unit.z(), &hits.normal_z[i]);
    keep(found.is_hit, Uint4{} + identity.surface, &hits.surface[i]);
    keep(found.is_hit, Uint4{} + identity.triangle, &hits.triangle[i]);
  }
}

void LaneTriangles::set(std::size_t lane,
                        const std::array<Eigen::Vector3f, 3>& corners,
                        std::uint32_t its_surface) {
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<std::size_t>(axis);
    first.at(k).at(lane) = corners[0][axis];
    a.at(k).at(lane) = corners[1][axis] - corners[0][axis];
    b.at(k).at(lane) = corners[2][axis] - corners[0][axis];
  }
  surface.at(lane) = its_surface;
}

void intersect_lane_triangles(const LaneTriangles& own, const RayPacket& rays, HitPacket& hits) {
  const auto load = [](const std::array<RayPacket::Lanes<float>, 3>& v, std::size_t i) {
    return Vector4x3{load4(&v[0][i]), load4(&v[1][i]), load4(&v[2][i])};
  };
  for (std::size_t i = 0; i < RayPacket::kSize; i += 4) {
    const Vector4x3 a = load(own.a, i);
    const Vector4x3 b = load(own.b, i);
    const Vector4x3 n = {
        a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    const Sides<Vector4x3> triangles{.first = load(own.first, i), .a = a, .b = b, .n = n};
    const Met found = met(triangles, rays, hits, i);
    if (!any(found.is_hit)) continue;
    const Float4 scale = found.side / square_root(dot(n, n));
    keep(found.is_hit, found.distance_m, &hits.distance_m[i]);
    keep(found.is_hit, scale * n[0], &hits.normal_x[i]);
    keep(found.is_hit, scale * n[1], &hits.normal_y[i]);
    keep(found.is_hit, scale * n[2], &hits.normal_z[i]);
    keep(found.is_hit, load4(&own.surface[i]), &hits.surface[i]);
    keep(found.is_hit, load4(&own.triangle[i]), &hits.triangle[i]);
  }
}

}  // namespace fleetloc
