#include "deploy/sim/world/session_scene.hpp"

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

/// How much of something there is in a session, and how much of it is not as in the survey.
struct Change {
  float present_in_survey;
  float present;
  float changed;
};

/// A number for each name, so that sessions draw apart from each other (FNV-1a).
std::uint64_t seed_of(std::uint64_t seed, const std::string& session) {
  std::uint64_t hash = 0xcbf29ce484222325U ^ seed;
  for (const char letter : session) {
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
  Furnisher(const Scene& scene, const SessionConfig& session, const SessionConfig& survey)
      : scene_(&scene),
        is_survey_(session.name == survey.name),
        session_seed_(seed_of(scene.seed, session.name)) {}

  /// What stands in a slot; `first_index` tells kinds of slots apart.
  [[nodiscard]] const Thing* standing(const Slot& slot,
                                      std::uint64_t index,
                                      const Change& change) const {
    Draw first(scene_->seed, Lot::kSession, index);
    auto variant = drawn_variant(slot, change.present_in_survey, first);
    if (!is_survey_) {
      Draw draw(session_seed_, Lot::kSession, index);
      if (draw.chance(change.changed)) {
        const auto before = variant;
        variant = drawn_variant(slot, change.present, draw);
        if (variant && variant == before) variant = (*variant + 1) % slot.variants.size();
      }
    }
    return variant ? &slot.variants[*variant] : nullptr;
  }

  /// Some buildings are painted over or hung with posters.
  [[nodiscard]] Thing building(std::size_t index, float changed) const {
    Thing thing = scene_->buildings[index];
    Draw draw(session_seed_, Lot::kBuilding, index);
    if (is_survey_ || !draw.chance(changed)) return thing;
    const bool has_posters = draw.chance(0.4F);
    for (Surface& surface : thing.surfaces) {
      const bool is_wall = surface.pattern == Pattern::kPlaster ||
                           surface.pattern == Pattern::kBrick ||
                           surface.pattern == Pattern::kPanels;
      if (!is_wall) continue;
      surface.seed = draw.bits();
      surface.albedo = draw.uniform(0.25F, 0.6F);
      if (has_posters && draw.chance(0.5F)) surface.pattern = Pattern::kPoster;
    }
    return thing;
  }

  [[nodiscard]] std::uint64_t session_seed() const { return session_seed_; }

 private:
  const Scene* scene_;
  bool is_survey_;
  std::uint64_t session_seed_;
};

void dress(std::vector<Surface>& surfaces, const SessionConfig& session) {
  for (Surface& surface : surfaces) {
    if (surface.pattern == Pattern::kLeaves) surface.albedo *= session.leaf_albedo / kLeafAlbedo;
    if (surface.pattern == Pattern::kGrass) surface.albedo = session.grass_albedo;
  }
}

/// A structure; heaps are of snow where there is enough of it.
Thing in_season(const Thing& thing, const SessionConfig& session) {
  Thing copy = thing;
  const bool is_heap = thing.surfaces.size() == 1 && thing.surfaces[0].pattern == Pattern::kGravel;
  if (is_heap && session.snow >= kSnowHeapFrom) {
    copy.surfaces[0].pattern = Pattern::kSnow;
    copy.surfaces[0].albedo = 0.7F;
    copy.surfaces[0].takes_snow = false;
  }
  return copy;
}

Eigen::Vector3f sun_direction(const SessionConfig& session) {
  const float level = std::cos(session.sun_elevation_rad);
  return {level * std::cos(session.sun_azimuth_rad),
          level * std::sin(session.sun_azimuth_rad),
          std::sin(session.sun_elevation_rad)};
}

}  // namespace

SessionScene::SessionScene(Parts parts)
    : config_(std::move(parts.config)),
      route_(std::move(parts.route)),
      body_height_m_(parts.body_height_m),
      fixed_(parts.mesh),
      surfaces_(std::move(parts.surfaces)),
      movers_(std::move(parts.movers)),
      to_sun_(sun_direction(config_)),
      triangles_(parts.mesh.triangles.size()) {}

SceneView SessionScene::at(double time_s) const {
  if (movers_.empty()) return {.caster = fixed_, .surfaces = surfaces_};
  Mesh moving;
  std::vector<Surface> surfaces = surfaces_;
  for (const Mover& mover : movers_) {
    const Placement placement = mover.at(*route_, body_height_m_, time_s);
    Thing thing = mover.thing;
    for (Eigen::Vector3f& vertex : thing.mesh.vertices) vertex = placement.to_map(vertex);
    for (Surface& surface : thing.surfaces) {
      surface = make_surface(surface.pattern, surface.albedo, surface.seed, placement);
    }
    append(thing, moving, surfaces);
  }
  return {.caster = fixed_.with(moving), .surfaces = std::move(surfaces)};
}

SessionScene apply_session(const Scene& scene,
                           const SessionConfig& session,
                           const SessionConfig& survey) {
  const Furnisher furnisher(scene, session, survey);
  SessionScene::Parts parts{.config = session,
                            .route = scene.route,
                            .body_height_m = scene.body_height_m,
                            .mesh = {},
                            .surfaces = {},
                            .movers = {}};
  const auto add = [&](const Thing& thing) { append(thing, parts.mesh, parts.surfaces); };
  Thing ground = scene.ground;
  if (session.snow_depth_m > 0.0F) {
    cover_with_snow(ground, *scene.route, session.snow_depth_m, furnisher.session_seed());
  }
  add(ground);
  for (std::size_t i = 0; i < scene.buildings.size(); ++i) {
    add(furnisher.building(i, session.facades_changed));
  }
  for (const Thing& thing : scene.furniture) add(thing);
  if (session.has_leaves) {
    for (const Thing& thing : scene.leaves) add(thing);
  }
  const Change cars{.present_in_survey = survey.cars_present,
                    .present = session.cars_present,
                    .changed = session.cars_changed};
  const Change structures{.present_in_survey = survey.structures_present,
                          .present = session.structures_present,
                          .changed = session.structures_changed};
  for (std::size_t i = 0; i < scene.cars.size(); ++i) {
    if (const Thing* car = furnisher.standing(scene.cars[i], 2 * i, cars)) add(*car);
  }
  for (std::size_t i = 0; i < scene.structures.size(); ++i) {
    const Thing* structure = furnisher.standing(scene.structures[i], 2 * i + 1, structures);
    if (structure != nullptr) add(in_season(*structure, session));
  }
  dress(parts.surfaces, session);
  parts.movers = drawn_people(*scene.route, session.people_per_100_m, furnisher.session_seed());
  for (Mover& cyclist :
       drawn_cyclists(*scene.route, session.bicycles_per_100_m, furnisher.session_seed())) {
    parts.movers.push_back(std::move(cyclist));
  }
  return SessionScene(std::move(parts));
}

}  // namespace fleetloc
