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

/// A place where, by session, one of several things stands or none.
struct Slot {
  Footprint footprint;
  std::vector<Thing> variants;
};

/// Everything that can stand along a route; a session shows part of it. See apply_session().
struct Scene {
  std::uint64_t seed = 0;
  std::shared_ptr<const RouteField> route;
  float body_height_m = 0.0F;
  Thing ground;  ///< surfaces as in GroundSurface
  std::vector<Thing> buildings;
  std::vector<Thing> furniture;  ///< wood of trees, poles, walls, signs, ...
  std::vector<Thing> leaves;
  std::vector<Slot> cars;
  std::vector<Slot> structures;
};

/// The same for the same arguments. Nothing stands within the clearance of any part of the route,
/// and the ground passes below it.
///
/// @param route_map  positions of the body along the route, in its order
/// Throws std::invalid_argument for a route shorter than 0.5 m or not finite.
Scene build_scene(const SceneConfig& config,
                  std::span<const Eigen::Vector3d> route_map,
                  std::uint64_t seed);

}  // namespace fleetloc
