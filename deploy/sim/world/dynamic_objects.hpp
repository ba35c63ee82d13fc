#pragma once

#include <cstdint>
#include <vector>

#include "deploy/sim/world/route_field.hpp"
#include "deploy/sim/world/shapes.hpp"

namespace fleetloc {

/// A person or a cyclist who goes to and fro along a piece of the route, beside the robot's track.
struct DynamicObject {
  SceneObject object;    ///< in its own frame, x forward
  float arc_m = 0.0F;    ///< middle of its way
  float reach_m = 0.0F;  ///< to both sides of that
  float speed_m_per_s = 0.0F;
  float lateral_m = 0.0F;
  float start_s = 0.0F;  ///< of its round

  /// Where it stands; a function of time alone.
  [[nodiscard]] Placement at(const RouteField& route, float body_height_m, double time_s) const;
};

/// Spread over the whole route.
std::vector<DynamicObject> drawn_people(const RouteField& route,
                                        float per_100_m,
                                        std::uint64_t seed);
std::vector<DynamicObject> drawn_cyclists(const RouteField& route,
                                          float per_100_m,
                                          std::uint64_t seed);

}  // namespace fleetloc
