#include "deploy/sim/world/ground.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "deploy/sim/world/draw.hpp"

namespace fleetloc {
namespace {

constexpr float kReach_m = 14.0F;      // within which the route decides the height
constexpr float kMinBelow = 0.6F;      // share of the body's height that is free below it anywhere
constexpr float kFlatWithin_m = 3.0F;  // of the route there are no hills
constexpr float kHillyFrom_m = 25.0F;
constexpr float kBumps_m = 0.12F;  // beside the route, where there is relief
constexpr float kVerge_m = 1.5F;   // width, on both sides of the path

GroundSurface surface_at(float distance_m, float half_path_m) {
  if (distance_m < half_path_m) return kPath;
  return distance_m < half_path_m + kVerge_m ? kVerge : kGrass;
}

}  // namespace

Ground::Ground(const RouteField& route, const SceneConfig& config, std::uint64_t seed)
    : route_(&route), config_(&config), seed_(Draw(seed, RandomStream::kGround, 0).bits()) {}

float Ground::height(const Eigen::Vector2f& p) const {
  // The farther from the route, the more of it counts, so that the slope across stays gentle.
  const float distance = route_->distance(p, config_->half_width_m + 10.0F);
  const float reach = distance + kReach_m;
  float sum = 0.0F;
  float weights = 0.0F;
  float ceiling = 1e9F;
  for (const Eigen::Vector3f& point : route_->near(p, reach)) {
    const float square = (point.head<2>() - p).squaredNorm();
    const float fade = 1.0F - square / (reach * reach);
    const float weight = fade * fade / (square + 0.3F);
    sum += weight * point.z();
    weights += weight;
    if (square < 4.0F) {
      ceiling = std::min(ceiling, point.z() - kMinBelow * config_->body_height_m);
    }
  }
  const float level =
      (weights > 0.0F ? sum / weights : route_->points()[0].z()) - config_->body_height_m;
  const float share =
      std::clamp((distance - kFlatWithin_m) / (kHillyFrom_m - kFlatWithin_m), 0.0F, 1.0F);
  const float scale = 1.0F / config_->ground.relief_length_m;
  const float hill = smooth_noise(p.x() * scale, p.y() * scale, seed_) - 0.4F;
  const float bumps = smooth_noise(p.x() * 0.4F, p.y() * 0.4F, seed_ + 1U) - 0.5F;
  const float roughness_m = config_->ground.relief_m > 0.0F ? kBumps_m : 0.0F;
  return std::min(
      level + share * share * config_->ground.relief_m * hill + roughness_m * share * bumps,
      ceiling);
}

SceneObject Ground::object() const {
  SceneObject ground;
  add_surface(ground, Pattern::kSlabs, 0.38F, seed_);
  add_surface(ground, Pattern::kGravel, 0.45F, seed_ + 1U);
  add_surface(ground, Pattern::kGrass, 0.25F, seed_ + 2U);
  const float cell = config_->ground.cell_m;
  std::map<std::pair<int, int>, std::uint32_t> vertices;  // by their place on the grid
  const auto vertex = [&](int i, int k) {
    const auto [found, is_new] =
        vertices.try_emplace({i, k}, static_cast<std::uint32_t>(ground.mesh.vertices.size()));
    if (is_new) {
      const Eigen::Vector2f p(cell * static_cast<float>(i), cell * static_cast<float>(k));
      ground.mesh.vertices.emplace_back(p.x(), p.y(), height(p));
    }
    return found->second;
  };
  Eigen::Vector2f min = route_->points()[0].head<2>();
  Eigen::Vector2f max = min;
  for (const auto& point : route_->points()) {
    min = min.cwiseMin(point.head<2>());
    max = max.cwiseMax(point.head<2>());
  }
  const auto index = [&](float x) { return static_cast<int>(std::floor(x / cell)); };
  const float half_width = config_->half_width_m;
  for (int i = index(min.x() - half_width); i <= index(max.x() + half_width); ++i) {
    for (int k = index(min.y() - half_width); k <= index(max.y() + half_width); ++k) {
      const Eigen::Vector2f center =
          cell * Eigen::Vector2f(static_cast<float>(i) + 0.5F, static_cast<float>(k) + 0.5F);
      const float distance = route_->distance(center, half_width);
      if (distance >= half_width) continue;
      const std::uint32_t surface = surface_at(distance, 0.5F * config_->ground.path_width_m);
      const std::uint32_t a = vertex(i, k);
      const std::uint32_t b = vertex(i + 1, k);
      const std::uint32_t c = vertex(i + 1, k + 1);
      const std::uint32_t d = vertex(i, k + 1);
      ground.mesh.triangles.insert(ground.mesh.triangles.end(), {{a, b, c}, {a, c, d}});
      ground.mesh.surfaces.insert(ground.mesh.surfaces.end(), 2, surface);
    }
  }
  return ground;
}

void cover_with_snow(SceneObject& ground,
                     const RouteField& route,
                     float depth_m,
                     std::uint64_t seed) {
  constexpr float kHalfLane_m = 1.2F;
  constexpr float kHeap_m = 3.0F;   // beside the lane; beyond the snow lies as it fell
  constexpr float kHeaped = 0.6F;   // beside the lane, in depths
  constexpr float kSlope_m = 0.8F;  // from the lane up
  const std::uint32_t drifts = Draw(seed, RandomStream::kGround, 1).bits();
  for (Eigen::Vector3f& vertex : ground.mesh.vertices) {
    const float beside = route.distance(vertex.head<2>(), kHalfLane_m + kHeap_m) - kHalfLane_m;
    if (beside <= 0.0F) continue;
    const float drift = 0.7F + 0.6F * smooth_noise(0.15F * vertex.x(), 0.15F * vertex.y(), drifts);
    const float heap = kHeaped * (1.0F - beside / kHeap_m);
    vertex.z() += depth_m * (drift + heap) * std::min(1.0F, beside / kSlope_m);
  }
}

}  // namespace fleetloc
