#include "deploy/sim/world/ray_caster.hpp"

#include <cmath>
#include <stdexcept>

#include <gmock/gmock.h>

namespace fleetloc {
namespace {

/// A square of 20 x 20 m at height z.
void add_floor(Mesh& mesh, float z, std::uint32_t surface) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(),
                       {{-10, -10, z}, {10, -10, z}, {10, 10, z}, {-10, 10, z}});
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
  mesh.surfaces.insert(mesh.surfaces.end(), 2, surface);
}

Mesh two_floors() {
  Mesh mesh;
  add_floor(mesh, 0.0F, 3);
  add_floor(mesh, -2.0F, 4);
  return mesh;
}

TEST(RayCaster, FindsTheNearestSurfaceAndTheSideThatIsSeen) {
  const RayCaster caster(two_floors());
  const auto from_above = caster.first_hit({{1.0F, 2.0F, 5.0F}, {0.0F, 0.0F, -1.0F}}, 50.0F);
  ASSERT_TRUE(from_above);
  EXPECT_FLOAT_EQ(from_above->distance_m, 5.0F);
  EXPECT_EQ(from_above->surface, 3U);
  EXPECT_FLOAT_EQ(from_above->normal_map.z(), 1.0F);
  const auto from_below = caster.first_hit({{1.0F, 2.0F, -5.0F}, {0.0F, 0.0F, 1.0F}}, 50.0F);
  ASSERT_TRUE(from_below);
  EXPECT_EQ(from_below->surface, 4U);
  EXPECT_FLOAT_EQ(from_below->normal_map.z(), -1.0F);
  EXPECT_FALSE(caster.first_hit({{1.0F, 2.0F, 5.0F}, {0.0F, 0.0F, -1.0F}}, 4.9F));
  EXPECT_FALSE(caster.first_hit({{1.0F, 2.0F, 5.0F}, {0.0F, 0.0F, 1.0F}}, 50.0F));
}

/// Sixteen beside each other, without the seventh.
RayPacket downward_rays() {
  RayPacket rays{};
  for (std::size_t i = 0; i < RayPacket::kSize; ++i) {
    const float x = static_cast<float>(i) - 2.5F;
    const Eigen::Vector3f direction = Eigen::Vector3f(0.05F * x, 0.02F, -1.0F).normalized();
    rays.origin_x[i] = x;
    rays.origin_y[i] = 0.3F;
    rays.origin_z[i] = 4.0F;
    rays.direction_x[i] = direction.x();
    rays.direction_y[i] = direction.y();
    rays.direction_z[i] = direction.z();
    rays.min_m[i] = 0.0F;
    rays.max_m[i] = i == 6 ? -1.0F : 100.0F;
  }
  return rays;
}

TEST(RayCaster, APacketSaysTheSameAsItsRays) {
  Mesh moving;
  add_floor(moving, 1.0F, 7);
  for (auto& vertex : moving.vertices) vertex.x() += 10.0F;  // over one half
  const RayCaster caster = RayCaster(two_floors()).with(moving);
  const RayPacket rays = downward_rays();
  const HitPacket hits = caster.first_hits(rays);
  const std::uint32_t shadow = caster.occluded(rays);
  for (std::size_t i = 0; i < RayPacket::kSize; ++i) {
    const bool used = i != 6;
    EXPECT_EQ((shadow >> i) & 1U, used ? 1U : 0U);
    EXPECT_EQ(std::isfinite(hits.distance_m[i]), used);
    if (!used) continue;
    const auto hit =
        caster.first_hit({{rays.origin_x[i], rays.origin_y[i], rays.origin_z[i]},
                          {rays.direction_x[i], rays.direction_y[i], rays.direction_z[i]}},
                         100.0F);
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hits.distance_m[i], hit->distance_m, 1e-5F);
    EXPECT_EQ(hits.surface[i], hit->surface);
    EXPECT_EQ(hit->surface, i < 3 ? 3U : 7U);
    EXPECT_FLOAT_EQ(hits.normal_z[i], 1.0F);
  }
}

TEST(RayCaster, RaysThatMissTheTrianglesTheyAreExpectedOnAreTraced) {
  Mesh moving;
  add_floor(moving, 1.0F, 7);
  for (auto& vertex : moving.vertices) vertex.x() += 10.0F;
  const RayCaster caster = RayCaster(two_floors()).with(moving);
  const RayPacket rays = downward_rays();
  const HitPacket hits = caster.first_hits(rays);
  const std::array<std::uint32_t, 1> upper = {hits.triangle.back()};
  ASSERT_NE(hits.triangle.front(), upper[0]);
  const HitPacket again = caster.first_hits_on(upper, rays);
  for (std::size_t i = 0; i < RayPacket::kSize; ++i) {
    if (rays.max_m[i] < 0.0F) {
      EXPECT_EQ(again.distance_m[i], HitPacket::kNone);
      continue;
    }
    EXPECT_NEAR(again.distance_m[i], hits.distance_m[i], 1e-5F);
    EXPECT_FLOAT_EQ(again.normal_z[i], hits.normal_z[i]);
    EXPECT_EQ(again.surface[i], hits.surface[i]);
    EXPECT_EQ(again.triangle[i], hits.triangle[i]);
  }
}

TEST(RayCaster, EachRayMeetsTheNearerOfItsOwnTriangles) {
  Mesh moving;
  add_floor(moving, 1.0F, 7);
  for (auto& vertex : moving.vertices) vertex.x() += 10.0F;
  const RayCaster caster = RayCaster(two_floors()).with(moving);
  const RayPacket rays = downward_rays();
  const HitPacket hits = caster.first_hits(rays);
  const std::uint32_t moved = hits.triangle.back();
  RayCaster::TrianglePairs own{};
  own[0] = hits.triangle;
  own[1].fill(moved);
  own[0][1] = HitPacket::kNoTriangle;  // and the moved one does not lie in its way
  own[0][9] = hits.triangle[0];        // of the fixed floor, behind the other or beside the ray
  own[1][9] = hits.triangle[9];
  const HitPacket again = caster.first_hits_on_pairs(own, rays);
  for (std::size_t i = 0; i < RayPacket::kSize; ++i) {
    if (i == 1 || i == 6) {
      EXPECT_EQ(again.distance_m[i], HitPacket::kNone);
      continue;
    }
    EXPECT_NEAR(again.distance_m[i], hits.distance_m[i], 1e-5F);
    EXPECT_FLOAT_EQ(again.normal_z[i], hits.normal_z[i]);
    EXPECT_EQ(again.surface[i], hits.surface[i]);
    EXPECT_EQ(again.triangle[i], hits.triangle[i]);
  }
}

TEST(RayCaster, SurfacesOfTheEndPointsHideNothing) {
  const RayCaster caster(two_floors());
  EXPECT_FALSE(caster.occluded({0, 0, 0}, {1, 1, 5}));
  EXPECT_FALSE(caster.occluded({0, 0, 5}, {1, 1, 0}));
  EXPECT_TRUE(caster.occluded({0, 0, 1}, {0, 0, -1}));
  EXPECT_FALSE(caster.occluded({0, 0, 0}, {0, 0, 0.001F}));
}

TEST(RayCaster, KnowsHowNearASurfaceIs) {
  const RayCaster caster(two_floors());
  EXPECT_TRUE(caster.has_surface_within({2, 3, 0.29F}, 0.3F));
  EXPECT_FALSE(caster.has_surface_within({2, 3, 0.31F}, 0.3F));
  EXPECT_TRUE(caster.has_surface_within({10.2F, 3, 0.2F}, 0.3F));  // beyond the edge
  EXPECT_FALSE(caster.has_surface_within({10.25F, 3, 0.2F}, 0.3F));
  EXPECT_FALSE(caster.has_surface_within({10.25F, 10.25F, 0.0F}, 0.3F));  // beyond the corner
}

TEST(RayCaster, NothingIsHitInAnEmptyMesh) {
  const RayCaster caster(Mesh{});
  EXPECT_FALSE(caster.first_hit({{0, 0, 0}, {1, 0, 0}}, 100.0F));
  EXPECT_FALSE(caster.has_surface_within({0, 0, 0}, 1.0F));
  EXPECT_TRUE(caster.with(two_floors()).first_hit({{0, 0, 1}, {0, 0, -1}}, 100.0F));
}

TEST(RayCaster, RefusesAMeshThatIsNotOne) {
  Mesh mesh = two_floors();
  mesh.triangles[0][1] = 99;
  EXPECT_THROW(RayCaster{mesh}, std::invalid_argument);
  mesh = two_floors();
  mesh.vertices[2].y() = std::nanf("");
  EXPECT_THROW(RayCaster{mesh}, std::invalid_argument);
  mesh = two_floors();
  mesh.surfaces.pop_back();
  EXPECT_THROW(RayCaster{mesh}, std::invalid_argument);
}

}  // namespace
}  // namespace fleetloc
