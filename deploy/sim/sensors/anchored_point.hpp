#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include <Eigen/Geometry>

#include "deploy/sim/world/season_scene.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// A point fixed to a surface, which moves with the surface's object.
struct AnchoredPoint {
  std::uint32_t surface = 0;  ///< index of SceneView::surfaces
  Eigen::Vector3d p_object = Eigen::Vector3d::Zero();
};

inline Pose T_map_object(const Surface& surface) {
  return {.R = Eigen::Quaterniond(Eigen::AngleAxisd(static_cast<double>(surface.frame.yaw_rad),
                                                    Eigen::Vector3d::UnitZ())),
          .p = surface.frame.p_map.cast<double>()};
}

inline Eigen::Vector3d p_map(const AnchoredPoint& point, const SceneView& world) {
  return T_map_object(world.surfaces[point.surface]) * point.p_object;
}

/// First hit of a ray from `from_map` within `max_m`; nothing if there is none.
inline std::optional<AnchoredPoint> first_point(const Eigen::Vector3d& from_map,
                                                const Eigen::Vector3d& direction_map,
                                                double max_m,
                                                const SceneView& world) {
  const auto hit = world.caster.first_hit(
      {.origin_map = from_map.cast<float>(), .direction_map = direction_map.cast<float>()},
      static_cast<float>(max_m));
  if (!hit) return std::nullopt;
  const Eigen::Vector3d p = from_map + static_cast<double>(hit->distance_m) * direction_map;
  return AnchoredPoint{.surface = hit->surface,
                       .p_object = inverse(T_map_object(world.surfaces[hit->surface])) * p};
}

}  // namespace fleetloc
