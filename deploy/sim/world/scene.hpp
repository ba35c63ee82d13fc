#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "deploy/sim/world/ground.hpp"
#include "deploy/sim/world/route_field.hpp"
#include "deploy/sim/world/scene_config.hpp"
#include "deploy/sim/world/shapes.hpp"

namespace fleetloc {

/// A place that, by season, holds one of several objects or none.
struct Slot {
  Footprint footprint;
  std::vector<SceneObject> variants;
};

/// Everything that can stand along a route; a season shows part of it. See apply_season().
struct Scene {
  std::uint64_t seed = 0;
  std::shared_ptr<const RouteField> route;
  float body_height_m = 0.0F;
  SceneObject ground;  ///< surfaces as in GroundSurface
  std::vector<SceneObject> buildings;
  std::vector<SceneObject> furniture;  ///< wood of trees, poles, walls, signs, ...
  std::vector<SceneObject> leaves;
  std::vector<Slot> cars;
  std::vector<Slot> structures;
};

/// Deterministic. Nothing stands within the clearance of any part of the route, and the ground
/// passes below it.
///
/// @param route_map  positions of the body along the route, in its order
/// Throws std::invalid_argument for a route shorter than 0.5 m or not finite, and for a row of the
/// configuration that stands in its way.
Scene build_scene(const SceneConfig& config,
                  std::span<const Eigen::Vector3d> route_map,
                  std::uint64_t seed);

}  // namespace fleetloc
