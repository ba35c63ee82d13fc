#pragma once

#include <cstdint>

#include "deploy/sim/world/route_field.hpp"
#include "deploy/sim/world/scene_config.hpp"
#include "deploy/sim/world/shapes.hpp"

namespace fleetloc {

/// The ground around a route: `body_height_m` below it, with a smooth transition to hills beside
/// it.
class Ground {
 public:
  Ground(const RouteField& route, const SceneConfig& config, std::uint64_t seed);

  /// In map [m]; defined within the strip around the route.
  [[nodiscard]] float height(const Eigen::Vector2f& p) const;

  /// Its surfaces are those of GroundSurface.
  [[nodiscard]] SceneObject object() const;

 private:
  const RouteField* route_;
  const SceneConfig* config_;
  std::uint32_t seed_;
};

/// Snow on the ground of Ground::object(): about `depth_m` deep, cleared from a lane along the
/// route and heaped up beside it.
void cover_with_snow(SceneObject& ground,
                     const RouteField& route,
                     float depth_m,
                     std::uint64_t seed);

enum GroundSurface : std::uint32_t { kPath, kVerge, kGrass };

}  // namespace fleetloc
