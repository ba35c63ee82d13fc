#pragma once

#include <cstdint>
#include <vector>

#include "deploy/sim/world/route_field.hpp"
#include "deploy/sim/world/shapes.hpp"

namespace fleetloc {

/// A person or a cyclist who moves back and forth along a section of the route, beside the robot's
/// path.
struct DynamicObject {
  SceneObject object;          ///< in its own frame, x forward
  float arc_m = 0.0F;          ///< middle of the section, along the route
  float half_length_m = 0.0F;  ///< of the section
  float speed_m_per_s = 0.0F;
  float lateral_m = 0.0F;
  float start_s = 0.0F;  ///< offset of its time

  /// Its placement; a function of time alone.
  [[nodiscard]] Placement at(const RouteField& route, float body_height_m, double time_s) const;
};

/// At random over the whole route.
std::vector<DynamicObject> drawn_people(const RouteField& route,
                                        float per_100_m,
                                        std::uint64_t seed);
std::vector<DynamicObject> drawn_cyclists(const RouteField& route,
                                          float per_100_m,
                                          std::uint64_t seed);

}  // namespace fleetloc
