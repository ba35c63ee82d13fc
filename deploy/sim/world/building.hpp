#pragma once

#include "deploy/sim/world/draw.hpp"
#include "deploy/sim/world/shapes.hpp"

namespace fleetloc {

struct BuildingShape {
  Placement placement;        ///< middle of the base; its x axis runs along the facade
  Eigen::Vector3f size_m;     ///< along the facade, in depth, in height
  float foundation_m = 0.0F;  ///< depth of the walls below the base
};

/// Walls of one kind each, windows with frames, bars and sills, a door, bands of trim and a roof.
SceneObject make_building(const BuildingShape& shape, Draw& draw);

}  // namespace fleetloc
