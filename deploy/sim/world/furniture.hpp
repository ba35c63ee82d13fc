#pragma once

#include <Eigen/Core>

#include "deploy/sim/world/draw.hpp"
#include "deploy/sim/world/shapes.hpp"

namespace fleetloc {

// Street furniture. `placement` is the middle of the base, on the ground; the x axis runs along the
// route. They reach a little below the ground, because that may slope.

SceneObject make_pole(const Placement& placement, Draw& draw);
SceneObject make_sign(const Placement& placement, Draw& draw);
SceneObject make_wall(const Placement& placement, const Eigen::Vector3f& size_m, Draw& draw);
SceneObject make_bench_or_boxes(const Placement& placement, Draw& draw);

/// Within kCarSize.
SceneObject make_car(const Placement& placement, Draw& draw);
inline const Eigen::Vector2f kCarSize{4.6F, 1.9F};

/// A container, a scaffold with nets, a stall, a fence of boards or a heap (of earth; in winter
/// of snow), within kStructureSize. `kind` counts these.
SceneObject make_structure(const Placement& placement, int kind, Draw& draw);
inline constexpr int kStructureKinds = 5;
inline const Eigen::Vector2f kStructureSize{7.2F, 2.6F};

}  // namespace fleetloc
