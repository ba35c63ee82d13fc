#include "deploy/sim/world/scene_config.hpp"

#include <algorithm>
#include <numbers>

namespace fleetloc {
namespace {

constexpr float kRadians = std::numbers::pi_v<float> / 180.0F;

float within(ConfigReader& config, const std::string& key, double least, double most) {
  return static_cast<float>(config.number(key, least, most));
}

float positive(ConfigReader& config, const std::string& key) {
  return static_cast<float>(config.positive(key));
}

float share(ConfigReader& config, const std::string& key) {
  return within(config, key, 0.0, 1.0);
}

/// `least_<what>` and `most_<what>`.
Eigen::Vector2f range(ConfigReader& config, const std::string& what) {
  const float least = positive(config, "least_" + what);
  return {least, within(config, "most_" + what, least, 1e3)};
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
  return scene;
}

SessionConfig read_session(const std::string& name, ConfigReader config) {
  SessionConfig session{};
  session.name = name;
  session.sun_azimuth_rad = kRadians * within(config, "sun_azimuth_deg", -360.0, 360.0);
  session.sun_elevation_rad = kRadians * within(config, "sun_elevation_deg", 3.0, 90.0);
  session.sun = within(config, "sun", 0.0, 10.0);
  session.ambient = within(config, "ambient", 0.001, 10.0);
  session.haze_m = positive(config, "haze_m");
  session.has_leaves = config.get<bool>("has_leaves");
  session.leaf_albedo = share(config, "leaf_albedo");
  session.grass_albedo = share(config, "grass_albedo");
  session.snow = share(config, "snow");
  session.snow_depth_m = within(config, "snow_depth_m", 0.0, 1.0);
  session.cars_present = share(config, "cars_present");
  session.cars_changed = share(config, "cars_changed");
  session.structures_present = share(config, "structures_present");
  session.structures_changed = share(config, "structures_changed");
  session.facades_changed = share(config, "facades_changed");
  session.people_per_100_m = within(config, "people_per_100_m", 0.0, 200.0);
  session.bicycles_per_100_m = within(config, "bicycles_per_100_m", 0.0, 200.0);
  return session;
}

}  // namespace

WorldConfig read_world_config(ConfigReader config) {
  WorldConfig world{.scene = read_scene(config.section("scene")),
                    .survey = config.get<std::string>("survey"),
                    .sessions = {}};
  ConfigReader sessions = config.section("sessions");
  for (const std::string& name : sessions.keys()) {
    world.sessions.push_back(read_session(name, sessions.section(name)));
  }
  config.expect_fully_read();
  session_named(world, world.survey);
  return world;
}

const SessionConfig& session_named(const WorldConfig& world, const std::string& name) {
  std::string names;
  for (const SessionConfig& session : world.sessions) {
    if (session.name == name) return session;
    names += (names.empty() ? "" : ", ") + session.name;
  }
  throw ConfigError("session '" + name + "' is not in the world; there are: " + names);
}

}  // namespace fleetloc
