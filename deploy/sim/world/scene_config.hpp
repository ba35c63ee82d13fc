#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "deploy/sim/world/row.hpp"
#include "shared/config/config_reader.hpp"

namespace fleetloc {

/// What is built along a route; all of it stands clear of the whole route.
struct SceneConfig {
  struct Ground {
    float cell_m;
    float relief_m;         ///< of the hills beside the route, peak to peak; 0: smooth as well
    float relief_length_m;  ///< from hill to valley
    float path_width_m;     ///< paved, around the route
  };
  struct Buildings {
    float spacing_m;            ///< from one to the next along each side, gaps included
    Eigen::Vector2f setback_m;  ///< min and max, of the facade from the route
    Eigen::Vector2f height_m;
    Eigen::Vector2f width_m;  ///< along the route
  };
  /// Corners of a rectangle along the axes of map [m].
  struct Area {
    Eigen::Vector2f min_map;
    Eigen::Vector2f max_map;
  };
  struct Density {  ///< along 100 m of route, both sides together
    float trees;
    float poles;
    float walls;
    float signs;
    float clutter;     ///< benches, boxes, bushes
    float cars;        ///< parking places
    float structures;  ///< places where containers, scaffolds, stalls, ... may stand
  };
  float body_height_m;  ///< of the route above the ground
  float half_width_m;   ///< of the strip along the route in which there is anything
  float clearance_m;    ///< around the route, in which nothing stands
  Ground ground;
  Buildings buildings;
  Density per_100_m;
  std::vector<ObjectRow> rows;
  std::vector<Area> rows_alone;  ///< where nothing is drawn at random
};

/// One season of a scene.
struct SeasonConfig {
  std::string name;
  float sun_azimuth_rad;  ///< from map's x axis towards y
  float sun_elevation_rad;
  float sun;      ///< on a surface that faces it; 1 is a bright day
  float ambient;  ///< light of the sky
  float haze_m;   ///< distance at which the contrast has fallen by 63 %
  bool has_leaves;
  float leaf_albedo;
  float grass_albedo;
  float snow;          ///< share of the level ground under snow
  float snow_depth_m;  ///< beside the lane
  float cars_present;  ///< share of the parking places
  float cars_changed;  ///< share of them that differs from the survey
  float structures_present;
  float structures_changed;
  float facades_changed;  ///< share of facades that were painted over or hung with posters
  float people_per_100_m;
  float bicycles_per_100_m;
};

/// One world: a scene and its seasons.
struct WorldConfig {
  SceneConfig scene;
  std::string survey;  ///< season in which the map was made
  std::vector<SeasonConfig> seasons;
};

/// Strict; throws ConfigError, also if the survey is not among the seasons.
WorldConfig read_world_config(ConfigReader config);

/// Throws ConfigError, naming those there are.
const SeasonConfig& season_named(const WorldConfig& world, const std::string& name);

}  // namespace fleetloc
