#include "deploy/sim/world/row.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "deploy/sim/world/building.hpp"
#include "deploy/sim/world/furniture.hpp"
#include "deploy/sim/world/plants.hpp"
#include "shared/geometry/angle.hpp"

namespace fleetloc {
namespace {

constexpr double kFarthest_m = 1e4;

struct KindName {
  std::string_view name;
  RowItemKind kind;
  Eigen::Vector2f size_m;  // of the footprint; zero: that of the item
};

const std::array<KindName, 8>& kind_names() {
  using enum RowItemKind;
  static const std::array<KindName, 8> names = {{{"building", kBuilding, {0.0F, 0.0F}},
                                                 {"tree", kTree, {1.2F, 1.2F}},
                                                 {"pole", kPole, {2.8F, 0.5F}},
                                                 {"sign", kSign, {0.2F, 1.7F}},
                                                 {"wall", kWall, {0.0F, 0.0F}},
                                                 {"bench", kBench, {2.0F, 0.9F}},
                                                 {"car", kCar, kCarSize},
                                                 {"box", kBox, {0.0F, 0.0F}}}};
  return names;
}

const KindName& named(RowItemKind kind) {
  return *std::ranges::find(kind_names(), kind, &KindName::kind);
}

SceneObject make_box(const Placement& placement, const Eigen::Vector3f& size_m, Draw& draw) {
  SceneObject box;
  box.placement = placement;
  const std::uint32_t surface =
      add_surface(box, Pattern::kSlabs, draw.uniform(0.3F, 0.6F), draw.bits());
  add_box(box, {0.0F, 0.0F, 0.5F * size_m.z()}, size_m, surface);
  return box;
}

SceneObject made(const RowItem& item, const Placement& placement, Draw& draw) {
  switch (item.kind) {
    case RowItemKind::kBuilding:
      return make_building({.placement = placement, .size_m = item.size_m, .foundation_m = 1.0F},
                           draw);
    case RowItemKind::kPole:
      return make_pole(placement, draw);
    case RowItemKind::kSign:
      return make_sign(placement, draw);
    case RowItemKind::kWall:
      return make_wall(placement, item.size_m, draw);
    case RowItemKind::kBench:
      return make_bench_or_boxes(placement, draw);
    case RowItemKind::kCar:
      return make_car(placement, draw);
    default:
      return make_box(placement, item.size_m, draw);
  }
}

template <int N>
Eigen::Matrix<float, N, 1> numbers(ConfigReader& config, const std::string& key, double min) {
  const auto values = config.get<std::vector<double>>(key);
  if (values.size() != N) config.fail(key, "must be " + std::to_string(N) + " numbers");
  Eigen::Matrix<float, N, 1> result;
  for (int i = 0; i < N; ++i) {
    const double value = values[static_cast<std::size_t>(i)];
    if (!(value >= min && value <= kFarthest_m)) {
      config.fail(key,
                  std::to_string(value) + " is not within [" + std::to_string(min) + ", " +
                      std::to_string(kFarthest_m) + "]");
    }
    result[i] = static_cast<float>(value);
  }
  return result;
}

float yaw_rad(ConfigReader& config) {
  if (!config.has("yaw_deg")) return 0.0F;
  return static_cast<float>(kRadPerDeg * config.number("yaw_deg", -360.0, 360.0));
}

RowItemKind read_kind(ConfigReader& config) {
  const auto text = config.get<std::string>("kind");
  std::string all;
  for (const KindName& known : kind_names()) {
    if (known.name == text) return known.kind;
    all += (all.empty() ? "" : ", ") + std::string(known.name);
  }
  config.fail("kind", "'" + text + "' is none of " + all);
}

RowItem read_item(ConfigReader& config) {
  constexpr double kThinnest_m = 0.01;
  constexpr double kHighest_m = 100.0;
  constexpr int kVariants = 1000;
  RowItem item;
  item.kind = read_kind(config);
  item.at_m = numbers<2>(config, "at", -kFarthest_m);
  item.yaw_rad = yaw_rad(config);
  if (named(item.kind).size_m.isZero()) item.size_m = numbers<3>(config, "size_m", kThinnest_m);
  if (item.kind == RowItemKind::kBox && config.has("above_ground_m")) {
    item.above_ground_m = static_cast<float>(config.number("above_ground_m", 0.0, kHighest_m));
  }
  if (config.has("variant")) item.variant = config.integer("variant", 0, kVariants - 1);
  return item;
}

std::vector<RowItem> read_items(ConfigReader& row) {
  std::vector<RowItem> items;
  for (const YAML::Node& node : row.get<std::vector<YAML::Node>>("items")) {
    const std::string origin = "line " + std::to_string(node.Mark().line + 1) + ": item " +
                               std::to_string(items.size() + 1);
    try {
      ConfigReader item = ConfigReader::from_string(YAML::Dump(node), origin);
      items.push_back(read_item(item));
      item.expect_fully_read();
    } catch (const ConfigError& error) {
      row.fail("items", error.what());
    }
  }
  if (items.empty()) row.fail("items", "is empty");
  return items;
}

}  // namespace

std::vector<PlacedItem> placed_items(const ObjectRow& row,
                                     int place,
                                     float ground_m,
                                     std::uint64_t seed) {
  const Eigen::Vector2f origin = row.first_map + static_cast<float>(place) * row.step_map;
  const Placement T_map_place{.p_map = {origin.x(), origin.y(), ground_m}, .yaw_rad = row.yaw_rad};
  std::vector<PlacedItem> items;
  for (const RowItem& item : row.items) {
    const Placement placement{
        .p_map = T_map_place.to_map({item.at_m.x(), item.at_m.y(), item.above_ground_m}),
        .yaw_rad = row.yaw_rad + item.yaw_rad};
    const Eigen::Vector2f own_size = named(item.kind).size_m;
    PlacedItem placed{
        .footprint = {.center = placement.p_map.head<2>(),
                      .half_size = 0.5F * (own_size.isZero() ? item.size_m.head<2>() : own_size),
                      .yaw_rad = placement.yaw_rad},
        .lowest_m = item.above_ground_m,
        .solid = {},
        .leaves = {}};
    const auto index =
        static_cast<std::uint64_t>(item.kind) << 20U | static_cast<std::uint64_t>(item.variant);
    Draw draw(seed, RandomStream::kRow, index);
    if (item.kind == RowItemKind::kTree) {
      Tree tree = make_tree(placement, draw);
      placed.solid = std::move(tree.wood);
      placed.leaves = std::move(tree.crown);
    } else {
      placed.solid = made(item, placement, draw);
    }
    items.push_back(std::move(placed));
  }
  return items;
}

std::vector<ObjectRow> read_rows(ConfigReader rows) {
  constexpr int kMostPlaces = 1000;
  std::vector<ObjectRow> result;
  for (const std::string& name : rows.keys_in_order()) {
    ConfigReader config = rows.section(name);
    ObjectRow row{.name = name,
                  .first_map = numbers<2>(config, "first", -kFarthest_m),
                  .yaw_rad = yaw_rad(config),
                  .step_map = numbers<2>(config, "step_m", -kFarthest_m),
                  .count = config.integer("count", 1, kMostPlaces),
                  .items = read_items(config)};
    result.push_back(std::move(row));
  }
  return result;
}

}  // namespace fleetloc
