#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "deploy/sim/world/route_field.hpp"
#include "deploy/sim/world/shapes.hpp"
#include "shared/config/config_reader.hpp"

namespace fleetloc {

/// What can stand in a row.
enum class RowItemKind : std::uint8_t {
  kBuilding,
  kTree,
  kPole,
  kSign,
  kWall,
  kBench,
  kCar,
  kBox,  ///< plain: a pillar, a beam, a slab, ...
};

/// One thing of a row, in the frame of a place of the row.
struct RowItem {
  RowItemKind kind = RowItemKind::kBox;
  Eigen::Vector2f at_m = Eigen::Vector2f::Zero();
  float yaw_rad = 0.0F;
  Eigen::Vector3f size_m = Eigen::Vector3f::Zero();  ///< of a building, wall or box
  float above_ground_m = 0.0F;                       ///< of the lower side of a box
  int variant = 0;  ///< things of one kind with the same one look the same
};

/// The same things at equal distances. All copies are equal, to the vertex, but for rounding.
struct ObjectRow {
  std::string name;
  Eigen::Vector2f first_map = Eigen::Vector2f::Zero();  ///< the first place [m]
  float yaw_rad = 0.0F;                                 ///< of all places
  Eigen::Vector2f step_map = Eigen::Vector2f::Zero();   ///< from one place to the next [m]
  int count = 0;
  std::vector<RowItem> items;
};

/// Where items of a row stand in map, and what they are made of.
struct PlacedItem {
  Footprint footprint;
  float lowest_m = 0.0F;  ///< above the ground
  SceneObject solid;
  SceneObject leaves;  ///< of a tree; else empty
};

/// The items of one place of a row.
/// @param ground_m  height of the ground in map
/// @param seed      of the scene
std::vector<PlacedItem> placed_items(const ObjectRow& row,
                                     int place,
                                     float ground_m,
                                     std::uint64_t seed);

/// A mapping from names to rows: `first`, `yaw_deg`, `step_m`, `count` and `items`, a list of
/// {kind, at, yaw_deg, size_m, above_ground_m, variant}. Throws ConfigError.
std::vector<ObjectRow> read_rows(ConfigReader rows);

}  // namespace fleetloc
