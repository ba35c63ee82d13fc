#pragma once

#include "deploy/sim/world/draw.hpp"
#include "deploy/sim/world/shapes.hpp"

namespace fleetloc {

/// A tree in two objects: what stays in winter, and its leaves.
struct Tree {
  SceneObject wood;
  SceneObject crown;
};
Tree make_tree(const Placement& placement, Draw& draw);

/// A bush of `radius_m`, leaves only.
SceneObject make_bush(const Placement& placement, float radius_m, Draw& draw);

}  // namespace fleetloc
