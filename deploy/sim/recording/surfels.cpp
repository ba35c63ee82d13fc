#include "deploy/sim/recording/surfels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "cloud/laser_map/point_index.hpp"

namespace fleetloc {
namespace {

constexpr std::array kUpright{Pattern::kPoster, Pattern::kBrick, Pattern::kPanels, Pattern::kPaint};
constexpr std::array kLevel{Pattern::kGravel, Pattern::kSlabs};
constexpr float kTile = 2.5F;        // a texture ends there [m]
constexpr std::uint32_t kSeeds = 8;  // of each pattern

std::vector<Surface> surfaces() {
  std::vector<Surface> result;
  const auto add = [&](const auto& patterns, float brightness) {
    for (const Pattern pattern : patterns) {
      for (std::uint32_t seed = 0; seed < kSeeds; ++seed) {
        const float albedo = brightness * (0.25F + 0.04F * static_cast<float>(seed));
        result.push_back(make_surface(pattern, albedo, seed + 1, Placement{}));
      }
    }
  };
  add(kUpright, 1.0F);
  add(kLevel, 0.6F);  // light comes from above
  return result;
}

/// Which of the surfaces is at a point: the same within a tile.
std::uint32_t surface_at(const MapPoint& point) {
  const bool level = std::abs(point.normal.z()) > 0.7F;
  const Eigen::Vector3i tile = (point.p_map / kTile).array().floor().cast<int>();
  const auto hash = static_cast<std::uint32_t>(tile.x() * 73856093) ^
                    static_cast<std::uint32_t>(tile.y() * 19349663) ^
                    static_cast<std::uint32_t>(tile.z() * 83492791);
  constexpr auto kFirstLevel = static_cast<std::uint32_t>(kUpright.size()) * kSeeds;
  constexpr auto kLevels = static_cast<std::uint32_t>(kLevel.size()) * kSeeds;
  const std::uint32_t mixed = (hash * 2654435761U) >> 8U;
  return level ? kFirstLevel + mixed % kLevels : mixed % kFirstLevel;
}

/// Half of the edge of the square at a point: by the distance to its fourth neighbour.
float half_edge(const MapPoint& point,
                const LaserMap& map,
                const PointIndex& index,
                const SurfelConfig& config) {
  constexpr std::size_t kNeighbour = 4;
  std::vector<double> distances;
  const double max_spacing = config.max_size_m / config.size_spacings;
  for (const std::size_t i : index.within(point.p_map.cast<double>(), max_spacing)) {
    distances.push_back(static_cast<double>((map.point(i).p_map - point.p_map).norm()));
  }
  if (distances.size() <= kNeighbour) return static_cast<float>(config.max_size_m);
  std::ranges::nth_element(distances, distances.begin() + kNeighbour);
  return static_cast<float>(config.size_spacings * distances[kNeighbour]);
}

void add_square(const MapPoint& point, float half_edge_m, Mesh& mesh) {
  const Eigen::Vector3f helper =
      std::abs(point.normal.z()) < 0.9F ? Eigen::Vector3f::UnitZ() : Eigen::Vector3f::UnitX();
  const Eigen::Vector3f a = half_edge_m * point.normal.cross(helper).normalized();
  const Eigen::Vector3f b = point.normal.cross(a);
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Eigen::Vector3f& corner : {Eigen::Vector3f(-a - b),
                                        Eigen::Vector3f(a - b),
                                        Eigen::Vector3f(a + b),
                                        Eigen::Vector3f(b - a)}) {
    mesh.vertices.emplace_back(point.p_map + corner);
  }
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
  mesh.surfaces.insert(mesh.surfaces.end(), 2, surface_at(point));
}

SeasonConfig light_from_everywhere() {
  SeasonConfig season{};
  season.name = "cloud";
  season.sun_elevation_rad = 1.0F;
  season.sun = 0.0F;
  season.ambient = 1.0F;
  season.haze_m = 1e6F;
  return season;
}

}  // namespace

SeasonScene surfel_scene(const LaserMap& map, const SurfelConfig& config) {
  SeasonScene::Parts parts{.config = light_from_everywhere(),
                           .route = nullptr,
                           .body_height_m = 0.0F,
                           .mesh = {},
                           .surfaces = surfaces(),
                           .dynamic_objects = {}};
  const PointIndex index(map.points());
  for (const MapPoint& point : map.points()) {
    if (point.normal.squaredNorm() < 0.5F) continue;
    add_square(point, half_edge(point, map, index, config), parts.mesh);
  }
  return SeasonScene(std::move(parts));
}

}  // namespace fleetloc
