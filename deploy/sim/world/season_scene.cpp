#include "deploy/sim/world/season_scene.hpp"

#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>

#include "deploy/sim/world/draw.hpp"

namespace fleetloc {
namespace {

constexpr float kLeafAlbedo = 0.3F;  // that plants are built with
constexpr float kSnowHeapFrom = 0.5F;

/// How much of a kind of object is there in a season, and how much of it differs from the survey.
struct Change {
  float present_in_survey;
  float present;
  float changed;
};

/// A number for each name, so that seasons have different random numbers (FNV-1a).
std::uint64_t seed_of(std::uint64_t seed, const std::string& season) {
  std::uint64_t hash = 0xcbf29ce484222325U ^ seed;
  for (const char letter : season) {
    hash = (hash ^ static_cast<unsigned char>(letter)) * 0x100000001b3U;
  }
  return hash;
}

/// One of the slot's variants or none.
std::optional<std::size_t> drawn_variant(const Slot& slot, float present, Draw& draw) {
  const bool is_present = draw.chance(present);
  const auto variant =
      static_cast<std::size_t>(draw.integer(static_cast<int>(slot.variants.size())));
  if (!is_present) return std::nullopt;
  return variant;
}

class Furnisher {
 public:
  Furnisher(const Scene& scene, const SeasonConfig& season, const SeasonConfig& survey)
      : scene_(&scene),
        is_survey_(season.name == survey.name),
        season_seed_(seed_of(scene.seed, season.name)) {}

  /// What stands in a slot; `first_index` tells kinds of slots apart.
  [[nodiscard]] const SceneObject* standing(const Slot& slot,
                                            std::uint64_t index,
                                            const Change& change) const {
    Draw first(scene_->seed, RandomStream::kSeason, index);
    auto variant = drawn_variant(slot, change.present_in_survey, first);
    if (!is_survey_) {
      Draw draw(season_seed_, RandomStream::kSeason, index);
      if (draw.chance(change.changed)) {
        const auto before = variant;
        variant = drawn_variant(slot, change.present, draw);
        if (variant && variant == before) variant = (*variant + 1) % slot.variants.size();
      }
    }
    return variant ? &slot.variants[*variant] : nullptr;
  }

  /// Some buildings are painted over or hung with posters.
  [[nodiscard]] SceneObject building(std::size_t index, float changed) const {
    SceneObject object = scene_->buildings[index];
    Draw draw(season_seed_, RandomStream::kBuilding, index);
    if (is_survey_ || !draw.chance(changed)) return object;
    const bool has_posters = draw.chance(0.4F);
    for (Surface& surface : object.surfaces) {
      const bool is_wall = surface.pattern == Pattern::kPlaster ||
                           surface.pattern == Pattern::kBrick ||
                           surface.pattern == Pattern::kPanels;
      if (!is_wall) continue;
      surface.seed = draw.bits();
      surface.albedo = draw.uniform(0.25F, 0.6F);
      if (has_posters && draw.chance(0.5F)) surface.pattern = Pattern::kPoster;
    }
    return object;
  }

  [[nodiscard]] std::uint64_t season_seed() const { return season_seed_; }

 private:
  const Scene* scene_;
  bool is_survey_;
  std::uint64_t season_seed_;
};

void dress(std::vector<Surface>& surfaces, const SeasonConfig& season) {
  for (Surface& surface : surfaces) {
    if (surface.pattern == Pattern::kLeaves) surface.albedo *= season.leaf_albedo / kLeafAlbedo;
    if (surface.pattern == Pattern::kGrass) surface.albedo = season.grass_albedo;
  }
}

/// A structure; heaps are of snow where there is enough of it.
SceneObject in_season(const SceneObject& object, const SeasonConfig& season) {
  SceneObject copy = object;
  const bool is_heap =
      object.surfaces.size() == 1 && object.surfaces[0].pattern == Pattern::kGravel;
  if (is_heap && season.snow >= kSnowHeapFrom) {
    copy.surfaces[0].pattern = Pattern::kSnow;
    copy.surfaces[0].albedo = 0.7F;
    copy.surfaces[0].takes_snow = false;
  }
  return copy;
}

Eigen::Vector3f sun_direction(const SeasonConfig& season) {
  const float level = std::cos(season.sun_elevation_rad);
  return {level * std::cos(season.sun_azimuth_rad),
          level * std::sin(season.sun_azimuth_rad),
          std::sin(season.sun_elevation_rad)};
}

}  // namespace

SeasonScene::SeasonScene(Parts parts)
    : config_(std::move(parts.config)),
      route_(std::move(parts.route)),
      body_height_m_(parts.body_height_m),
      fixed_(parts.mesh),
      surfaces_(std::move(parts.surfaces)),
      dynamic_objects_(std::move(parts.dynamic_objects)),
      to_sun_(sun_direction(config_)),
      triangles_(parts.mesh.triangles.size()) {}

SceneView SeasonScene::at(double time_s) const {
  if (dynamic_objects_.empty()) return {.caster = fixed_, .surfaces = surfaces_};
  Mesh moving;
  std::vector<Surface> surfaces = surfaces_;
  for (const DynamicObject& dynamic_object : dynamic_objects_) {
    const Placement placement = dynamic_object.at(*route_, body_height_m_, time_s);
    SceneObject object = dynamic_object.object;
    for (Eigen::Vector3f& vertex : object.mesh.vertices) vertex = placement.to_map(vertex);
    for (Surface& surface : object.surfaces) {
      surface = make_surface(surface.pattern, surface.albedo, surface.seed, placement);
    }
    append(object, moving, surfaces);
  }
  return {.caster = fixed_.with(moving), .surfaces = std::move(surfaces)};
}

SeasonScene apply_season(const Scene& scene,
                         const SeasonConfig& season,
                         const SeasonConfig& survey) {
  const Furnisher furnisher(scene, season, survey);
  SeasonScene::Parts parts{.config = season,
                           .route = scene.route,
                           .body_height_m = scene.body_height_m,
                           .mesh = {},
                           .surfaces = {},
                           .dynamic_objects = {}};
  const auto add = [&](const SceneObject& object) { append(object, parts.mesh, parts.surfaces); };
  SceneObject ground = scene.ground;
  if (season.snow_depth_m > 0.0F) {
    cover_with_snow(ground, *scene.route, season.snow_depth_m, furnisher.season_seed());
  }
  add(ground);
  for (std::size_t i = 0; i < scene.buildings.size(); ++i) {
    add(furnisher.building(i, season.facades_changed));
  }
  for (const SceneObject& object : scene.furniture) add(object);
  if (season.has_leaves) {
    for (const SceneObject& object : scene.leaves) add(object);
  }
  const Change cars{.present_in_survey = survey.cars_present,
                    .present = season.cars_present,
                    .changed = season.cars_changed};
  const Change structures{.present_in_survey = survey.structures_present,
                          .present = season.structures_present,
                          .changed = season.structures_changed};
  for (std::size_t i = 0; i < scene.cars.size(); ++i) {
    if (const SceneObject* car = furnisher.standing(scene.cars[i], 2 * i, cars)) add(*car);
  }
  for (std::size_t i = 0; i < scene.structures.size(); ++i) {
    const SceneObject* structure = furnisher.standing(scene.structures[i], 2 * i + 1, structures);
    if (structure != nullptr) add(in_season(*structure, season));
  }
  dress(parts.surfaces, season);
  parts.dynamic_objects =
      drawn_people(*scene.route, season.people_per_100_m, furnisher.season_seed());
  for (DynamicObject& cyclist :
       drawn_cyclists(*scene.route, season.bicycles_per_100_m, furnisher.season_seed())) {
    parts.dynamic_objects.push_back(std::move(cyclist));
  }
  return SeasonScene(std::move(parts));
}

}  // namespace fleetloc
