#include "deploy/sim/world/scene_config.hpp"

#include <algorithm>

#include "shared/geometry/angle.hpp"

namespace fleetloc {
namespace {

constexpr auto kRadians = static_cast<float>(kRadPerDeg);

float within(ConfigReader& config, const std::string& key, double min, double max) {
  return static_cast<float>(config.number(key, min, max));
}

float positive(ConfigReader& config, const std::string& key) {
  return static_cast<float>(config.positive(key));
}

float share(ConfigReader& config, const std::string& key) {
  return within(config, key, 0.0, 1.0);
}

/// `min_<what>` and `max_<what>`.
Eigen::Vector2f range(ConfigReader& config, const std::string& what) {
  const float min = positive(config, "min_" + what);
  return {min, within(config, "max_" + what, min, 1e3)};
}

std::vector<SceneConfig::Area> read_areas(ConfigReader& config, const std::string& key) {
  std::vector<SceneConfig::Area> areas;
  for (const auto& numbers : config.get<std::vector<std::vector<float>>>(key)) {
    if (numbers.size() != 4 || !(numbers[0] < numbers[2]) || !(numbers[1] < numbers[3])) {
      config.fail(key, "an area is [x_min, y_min, x_max, y_max] in m");
    }
    areas.push_back({.min_map = {numbers[0], numbers[1]}, .max_map = {numbers[2], numbers[3]}});
  }
  return areas;
}

SceneConfig read_scene(ConfigReader config) {
  SceneConfig scene{};
  scene.body_height_m = within(config, "body_height_m", 0.2, 5.0);
  scene.half_width_m = within(config, "half_width_m", 10.0, 200.0);
  scene.clearance_m = within(config, "clearance_m", 0.3, 20.0);
  ConfigReader ground = config.section("ground");
  scene.ground = {.cell_m = within(ground, "cell_m", 0.25, 10.0),
                  .relief_m = within(ground, "relief_m", 0.0, 50.0),
                  .relief_length_m = within(ground, "relief_length_m", 5.0, 1e4),
                  .path_width_m = positive(ground, "path_width_m")};
  ConfigReader buildings = config.section("buildings");
  scene.buildings = {.spacing_m = within(buildings, "spacing_m", 5.0, 1e4),
                     .setback_m = range(buildings, "setback_m"),
                     .height_m = range(buildings, "height_m"),
                     .width_m = range(buildings, "width_m")};
  ConfigReader density = config.section("per_100_m");
  scene.per_100_m = {.trees = within(density, "trees", 0.0, 200.0),
                     .poles = within(density, "poles", 0.0, 200.0),
                     .walls = within(density, "walls", 0.0, 200.0),
                     .signs = within(density, "signs", 0.0, 200.0),
                     .clutter = within(density, "clutter", 0.0, 200.0),
                     .cars = within(density, "cars", 0.0, 200.0),
                     .structures = within(density, "structures", 0.0, 200.0)};
  if (config.has("rows")) scene.rows = read_rows(config.section("rows"));
  if (config.has("rows_alone")) scene.rows_alone = read_areas(config, "rows_alone");
  return scene;
}

SeasonConfig read_season(const std::string& name, ConfigReader config) {
  SeasonConfig season{};
  season.name = name;
  season.sun_azimuth_rad = kRadians * within(config, "sun_azimuth_deg", -360.0, 360.0);
  season.sun_elevation_rad = kRadians * within(config, "sun_elevation_deg", 3.0, 90.0);
  season.sun = within(config, "sun", 0.0, 10.0);
  season.ambient = within(config, "ambient", 0.001, 10.0);
  season.haze_m = positive(config, "haze_m");
  season.has_leaves = config.get<bool>("has_leaves");
  season.leaf_albedo = share(config, "leaf_albedo");
  season.grass_albedo = share(config, "grass_albedo");
  season.snow = share(config, "snow");
  season.snow_depth_m = within(config, "snow_depth_m", 0.0, 1.0);
  season.cars_present = share(config, "cars_present");
  season.cars_changed = share(config, "cars_changed");
  season.structures_present = share(config, "structures_present");
  season.structures_changed = share(config, "structures_changed");
  season.facades_changed = share(config, "facades_changed");
  season.people_per_100_m = within(config, "people_per_100_m", 0.0, 200.0);
  season.bicycles_per_100_m = within(config, "bicycles_per_100_m", 0.0, 200.0);
  return season;
}

}  // namespace

WorldConfig read_world_config(ConfigReader config) {
  WorldConfig world{.scene = read_scene(config.section("scene")),
                    .survey = config.get<std::string>("survey"),
                    .seasons = {}};
  ConfigReader seasons = config.section("seasons");
  for (const std::string& name : seasons.keys()) {
    world.seasons.push_back(read_season(name, seasons.section(name)));
  }
  config.expect_fully_read();
  season_named(world, world.survey);
  return world;
}

const SeasonConfig& season_named(const WorldConfig& world, const std::string& name) {
  std::string names;
  for (const SeasonConfig& season : world.seasons) {
    if (season.name == name) return season;
    names += (names.empty() ? "" : ", ") + season.name;
  }
  throw ConfigError("season '" + name + "' is not in the world; there are: " + names);
}

}  // namespace fleetloc
