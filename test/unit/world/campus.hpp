#pragma once

#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "deploy/sim/world/scene.hpp"
#include "deploy/sim/world/scene_config.hpp"
#include "deploy/sim/world/season_scene.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// A figure of eight, 240 m long, on a slope; it crosses itself in the middle.
inline Eigen::Vector3d eight(double share) {
  const double angle = 2.0 * std::numbers::pi * share;
  return {
      48.0 * std::sin(angle), 28.0 * std::sin(2.0 * angle), 1.0 + 0.02 * 48.0 * std::sin(angle)};
}

inline std::vector<Eigen::Vector3d> eight() {
  std::vector<Eigen::Vector3d> route;
  for (int i = 0; i <= 400; ++i) route.push_back(eight(i / 400.0));
  return route;
}

/// Body at a share of the eight: its z axis is the camera's, looking ahead and `turn_rad` left.
inline Pose T_map_body_on_eight(double share, double turn_rad = 0.0) {
  const Eigen::Vector3d way = eight(share + 1e-4) - eight(share - 1e-4);
  const double heading = std::atan2(way.y(), way.x()) + turn_rad;
  Eigen::Matrix3d R;
  R.col(2) = Eigen::Vector3d(std::cos(heading), std::sin(heading), 0.0);
  R.col(1) = -Eigen::Vector3d::UnitZ();
  R.col(0) = R.col(1).cross(R.col(2));
  return {.R = Eigen::Quaterniond(R), .p = eight(share)};
}

inline WorldConfig campus() {
  return read_world_config(ConfigReader::from_file(std::filesystem::path(FLEETLOC_SOURCE_DIR) /
                                                   "deploy/worlds/campus.yaml"));
}

inline SeasonScene season_of(const WorldConfig& world,
                             const Scene& scene,
                             const std::string& name) {
  return apply_season(scene, season_named(world, name), season_named(world, world.survey));
}

}  // namespace fleetloc
