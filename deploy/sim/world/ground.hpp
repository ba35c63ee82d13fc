#pragma once

#include <cstdint>

#include "deploy/sim/world/route_field.hpp"
#include "deploy/sim/world/scene_config.hpp"
#include "deploy/sim/world/shapes.hpp"

namespace fleetloc {

/// The ground about a route: `body_height_m` below it, smoothly on to hills beside it.
class Ground {
 public:
  Ground(const RouteField& route, const SceneConfig& config, std::uint64_t seed);

  /// In map [m]; defined within the strip about the route, level with its nearest point beyond.
  [[nodiscard]] float height(const Eigen::Vector2f& p) const;

  /// Its surfaces are the paving, the verge and the grass, see GroundSurface.
  [[nodiscard]] SceneObject object() const;

 private:
  const RouteField* route_;
  const SceneConfig* config_;
  std::uint32_t seed_;
};

/// Snow on the ground of Ground::object(): `depth_m` deep, more and less, but for a lane along the
/// route, beside which it is heaped up.
void cover_with_snow(SceneObject& ground,
                     const RouteField& route,
                     float depth_m,
                     std::uint64_t seed);

enum GroundSurface : std::uint32_t { kPath, kVerge, kGrass };

}  // namespace fleetloc
