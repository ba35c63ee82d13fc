#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "deploy/sim/world/dynamic_objects.hpp"
#include "deploy/sim/world/ray_caster.hpp"
#include "deploy/sim/world/scene.hpp"
#include "deploy/sim/world/scene_config.hpp"
#include "deploy/sim/world/surface.hpp"

namespace fleetloc {

/// The world at one instant.
struct SceneView {
  RayCaster caster;
  std::vector<Surface> surfaces;  ///< Hit::surface counts these
};

/// The static and the dynamic objects of one season. Immutable, thread-safe.
class SeasonScene {
 public:
  struct Parts {
    SeasonConfig config;
    std::shared_ptr<const RouteField> route;
    float body_height_m = 0.0F;
    Mesh mesh;
    std::vector<Surface> surfaces;
    std::vector<DynamicObject> dynamic_objects;
  };
  explicit SeasonScene(Parts parts);

  /// With people and bicycles where they are; time counts from the start of the season. Times
  /// within a few milliseconds may share a view.
  [[nodiscard]] SceneView at(double time_s) const;

  /// The static objects.
  [[nodiscard]] const RayCaster& fixed() const { return fixed_; }
  [[nodiscard]] const SeasonConfig& config() const { return config_; }
  [[nodiscard]] const Eigen::Vector3f& to_sun() const { return to_sun_; }  ///< in map, unit length
  [[nodiscard]] std::size_t triangles() const { return triangles_; }

 private:
  SeasonConfig config_;
  std::shared_ptr<const RouteField> route_;
  float body_height_m_;
  RayCaster fixed_;
  std::vector<Surface> surfaces_;
  std::vector<DynamicObject> dynamic_objects_;
  Eigen::Vector3f to_sun_;
  std::size_t triangles_;
};

/// The scene as it is in `season`. What the season does not change is identical, to the vertex,
/// with `survey`. Deterministic.
SeasonScene apply_season(const Scene& scene,
                         const SeasonConfig& season,
                         const SeasonConfig& survey);

}  // namespace fleetloc
