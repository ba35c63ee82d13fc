#include "deploy/sim/world/scene.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

#include "deploy/sim/world/building.hpp"
#include "deploy/sim/world/draw.hpp"
#include "deploy/sim/world/furniture.hpp"
#include "deploy/sim/world/plants.hpp"

namespace fleetloc {
namespace {

constexpr float kBeyond_m = 35.0F;  // the ends of the route there are still objects

/// Places that are taken while the scene is built.
class Site {
 public:
  Site(const RouteField& route, const SceneConfig& config, std::uint64_t seed)
      : route_(&route), config_(&config), ground_(route, config, seed), seed_(seed) {}

  /// Takes the place if it is free, and if what hangs over its border stays off the route as well.
  bool claim(const Footprint& footprint, float overhang_m = 0.0F) {
    if (!route_->is_clear(footprint, config_->clearance_m + overhang_m)) return false;
    const float reach = config_->half_width_m - footprint.half_size.norm();
    if (route_->distance(footprint.center, config_->half_width_m) >= reach) return false;
    if (is_for_rows_alone(footprint.center)) return false;
    const auto taken = [&](const Footprint& other) { return other.overlaps(footprint); };
    if (std::any_of(taken_.begin(), taken_.end(), taken)) return false;
    taken_.push_back(footprint);
    return true;
  }

  /// Takes the place of what stands in a row. Throws std::invalid_argument if it is in the robot's
  /// way.
  void take_for_row(const PlacedItem& item, const std::string& row) {
    constexpr float kHeadroom_m = 2.0F;
    if (item.lowest_m < kHeadroom_m && !route_->is_clear(item.footprint, config_->clearance_m)) {
      std::ostringstream text;
      text << "row '" << row << "': what stands at x " << item.footprint.center.x() << ", y "
           << item.footprint.center.y() << " m is within the clearance of the route";
      throw std::invalid_argument(text.str());
    }
    taken_.push_back(item.footprint);
  }

  [[nodiscard]] Placement on_ground(const Footprint& footprint) const {
    return {.p_map = {footprint.center.x(), footprint.center.y(), ground_.height(footprint.center)},
            .yaw_rad = footprint.yaw_rad};
  }

  /// What is scattered along the route: how much, how large, where across it.
  struct Scatter {
    RandomStream lot;
    std::uint64_t first_index;
    float per_100_m;
    Eigen::Vector2f size_m;
    Eigen::Vector2f lateral_m;  ///< beyond the clearance
    float overhang_m = 0.0F;    ///< over the border of the place
  };

  /// Calls `make(footprint, draw)` for each free place found.
  template <typename Make>
  void scatter(const Scatter& what, const Make& make) {
    const float length = route_->length_m() + 2.0F * kBeyond_m;
    const auto count = static_cast<std::uint64_t>(what.per_100_m * length / 100.0F);
    for (std::uint64_t i = 0; i < count; ++i) {
      Draw draw(seed_, what.lot, what.first_index + i);
      constexpr int kTries = 4;
      for (int attempt = 0; attempt < kTries; ++attempt) {
        const Footprint footprint = drawn_place(what, draw);
        if (!claim(footprint, what.overhang_m)) continue;
        make(footprint, draw);
        break;
      }
    }
  }

  [[nodiscard]] const RouteField& route() const { return *route_; }
  [[nodiscard]] const SceneConfig& config() const { return *config_; }
  [[nodiscard]] const Ground& ground() const { return ground_; }
  [[nodiscard]] std::uint64_t seed() const { return seed_; }

 private:
  [[nodiscard]] bool is_for_rows_alone(const Eigen::Vector2f& p) const {
    return std::ranges::any_of(config_->rows_alone, [&p](const SceneConfig::Area& area) {
      return (p.array() >= area.min_map.array()).all() && (p.array() <= area.max_map.array()).all();
    });
  }

  [[nodiscard]] Footprint drawn_place(const Scatter& what, Draw& draw) const {
    const float arc = draw.uniform(-kBeyond_m, route_->length_m() + kBeyond_m);
    const float lateral = config_->clearance_m + 0.5F * what.size_m.y() + 0.15F +
                          draw.uniform(what.lateral_m.x(), what.lateral_m.y());
    const Eigen::Vector3f p = route_->beside(arc, draw.chance(0.5F) ? lateral : -lateral);
    return {.center = p.head<2>(),
            .half_size = 0.5F * what.size_m,
            .yaw_rad = route_->heading_rad(arc)};
  }

  const RouteField* route_;
  const SceneConfig* config_;
  Ground ground_;
  std::uint64_t seed_;
  std::vector<Footprint> taken_;
};

/// Tries farther from the route until the building fits.
std::optional<Footprint> building_place(
    Site& site, float arc, float side, const Eigen::Vector2f& size, float setback) {
  for (const float back : {0.0F, 4.0F, 9.0F, 16.0F}) {
    const Eigen::Vector3f p = site.route().beside(arc, side * (setback + back + 0.5F * size.y()));
    Footprint footprint{.center = p.head<2>(),
                        .half_size = 0.5F * size + Eigen::Vector2f(0.7F, 0.9F),  // eaves and sills
                        .yaw_rad = site.route().heading_rad(arc)};
    if (site.claim(footprint)) return footprint;
  }
  return std::nullopt;
}

void add_buildings(Site& site, Scene& scene) {
  const SceneConfig::Buildings& config = site.config().buildings;
  const float end = site.route().length_m() + kBeyond_m;
  std::uint64_t index = 0;
  for (const float side : {-1.0F, 1.0F}) {
    const int count = static_cast<int>((end + kBeyond_m) / config.spacing_m) + 1;
    for (int i = 0; i < count; ++i) {
      const float arc = -kBeyond_m + static_cast<float>(i) * config.spacing_m;
      Draw draw(site.seed(), RandomStream::kBuilding, index++);
      const float width =
          std::min(draw.uniform(config.width_m.x(), config.width_m.y()), config.spacing_m - 1.8F);
      const Eigen::Vector3f size(
          width, draw.uniform(8.0F, 13.0F), draw.uniform(config.height_m.x(), config.height_m.y()));
      const float setback = draw.uniform(config.setback_m.x(), config.setback_m.y());
      const auto footprint = building_place(site, arc, side, size.head<2>(), setback);
      if (!footprint) continue;
      scene.buildings.push_back(make_building(
          {.placement = site.on_ground(*footprint), .size_m = size, .foundation_m = 6.0F}, draw));
    }
  }
}

void add_rows(Site& site, Scene& scene) {
  for (const ObjectRow& row : site.config().rows) {
    for (int place = 0; place < row.count; ++place) {
      const Eigen::Vector2f p = row.first_map + static_cast<float>(place) * row.step_map;
      for (PlacedItem& item : placed_items(row, place, site.ground().height(p), site.seed())) {
        site.take_for_row(item, row.name);
        scene.furniture.push_back(std::move(item.solid));
        if (!item.leaves.mesh.vertices.empty()) scene.leaves.push_back(std::move(item.leaves));
      }
    }
  }
}

void add_structures(Site& site, Scene& scene) {
  site.scatter({.lot = RandomStream::kStructure,
                .first_index = 0,
                .per_100_m = site.config().per_100_m.structures,
                .size_m = kStructureSize,
                .lateral_m = {0.1F, 2.4F}},
               [&](const Footprint& footprint, Draw& draw) {
                 Slot slot{.footprint = footprint, .variants = {}};
                 for (int kind = 0; kind < kStructureKinds; ++kind) {
                   slot.variants.push_back(make_structure(site.on_ground(footprint), kind, draw));
                 }
                 scene.structures.push_back(std::move(slot));
               });
}

void add_cars(Site& site, Scene& scene) {
  constexpr float kPlay_m = 0.7F;  // of a car along its parking place
  site.scatter(
      {.lot = RandomStream::kCar,
       .first_index = 0,
       .per_100_m = site.config().per_100_m.cars,
       .size_m = kCarSize + Eigen::Vector2f(2.0F * kPlay_m, 0.2F),
       .lateral_m = {0.3F, 4.0F}},
      [&](const Footprint& footprint, Draw& draw) {
        Slot slot{.footprint = footprint, .variants = {}};
        for (int i = 0; i < 3; ++i) {
          Placement placement = site.on_ground(footprint);
          placement.p_map = placement.to_map({draw.uniform(-kPlay_m, kPlay_m), 0.0F, 0.0F});
          slot.variants.push_back(make_car(placement, draw));
        }
        scene.cars.push_back(std::move(slot));
      });
}

void add_plants(Site& site, Scene& scene) {
  const auto& density = site.config().per_100_m;
  site.scatter({.lot = RandomStream::kTree,
                .first_index = 0,
                .per_100_m = density.trees,
                .size_m = {1.2F, 1.2F},
                .lateral_m = {3.2F, 14.0F},
                .overhang_m = 3.3F},
               [&](const Footprint& footprint, Draw& draw) {
                 Tree tree = make_tree(site.on_ground(footprint), draw);
                 scene.furniture.push_back(std::move(tree.wood));
                 scene.leaves.push_back(std::move(tree.crown));
               });
  site.scatter({.lot = RandomStream::kTree,
                .first_index = 1U << 20U,
                .per_100_m = 0.6F * density.clutter,
                .size_m = {2.2F, 2.2F},
                .lateral_m = {0.6F, 9.0F},
                .overhang_m = 0.6F},
               [&](const Footprint& footprint, Draw& draw) {
                 scene.leaves.push_back(
                     make_bush(site.on_ground(footprint), draw.uniform(0.5F, 1.0F), draw));
               });
}

void add_furniture(Site& site, Scene& scene) {
  const auto& density = site.config().per_100_m;
  const auto place = [&](std::uint64_t kind,
                         float per_100_m,
                         const Eigen::Vector2f& size,
                         const Eigen::Vector2f& lateral,
                         auto make) {
    site.scatter({.lot = RandomStream::kFurniture,
                  .first_index = kind << 20U,
                  .per_100_m = per_100_m,
                  .size_m = size,
                  .lateral_m = lateral},
                 [&](const Footprint& footprint, Draw& draw) {
                   scene.furniture.push_back(make(site.on_ground(footprint), draw));
                 });
  };
  const Eigen::Vector2f wall_size(8.0F, 0.5F);
  place(0, density.walls, wall_size, {2.0F, 8.0F}, [&](const Placement& at, Draw& draw) {
    return make_wall(at, {wall_size.x() - 0.2F, 0.3F, draw.uniform(0.7F, 2.2F)}, draw);
  });
  place(1, density.poles, {2.8F, 0.5F}, {0.0F, 2.5F}, make_pole);
  place(2, density.signs, {0.2F, 1.7F}, {0.1F, 2.5F}, make_sign);
  place(3, density.clutter, {2.0F, 0.9F}, {0.1F, 5.0F}, make_bench_or_boxes);
}

}  // namespace

Scene build_scene(const SceneConfig& config,
                  std::span<const Eigen::Vector3d> route_map,
                  std::uint64_t seed) {
  Scene scene;
  scene.seed = seed;
  scene.body_height_m = config.body_height_m;
  scene.route = std::make_shared<const RouteField>(route_map);
  Site site(*scene.route, config, seed);
  scene.ground = site.ground().object();
  add_rows(site, scene);
  add_buildings(site, scene);
  add_structures(site, scene);
  add_cars(site, scene);
  add_furniture(site, scene);
  add_plants(site, scene);
  return scene;
}

}  // namespace fleetloc
