#pragma once

#include <filesystem>
#include <limits>
#include <map>
#include <string>

#include <Eigen/Core>

#include "shared/config/config_reader.hpp"

namespace fleetloc {

/// A part of a map: between upright walls about a rectangle or a circle, and of some storeys.
struct MapRegion {
  static constexpr double kUnlimited = std::numeric_limits<double>::infinity();

  Eigen::Vector2d min_map = Eigen::Vector2d::Constant(-kUnlimited);  ///< [m]
  Eigen::Vector2d max_map = Eigen::Vector2d::Constant(kUnlimited);
  double radius_m = kUnlimited;  ///< about the middle of the rectangle
  /// Of the ground that the robot stands on, or of itself if it flies [m].
  double lowest_m = -kUnlimited;
  double highest_m = kUnlimited;

  static MapRegion circle(const Eigen::Vector2d& center_map, double radius_m);
  /// Where nothing is.
  static MapRegion nowhere();

  /// @param margin_m  beside the region that belongs to it
  [[nodiscard]] bool has(const Eigen::Vector2d& p_map, double margin_m) const;
  /// @param ground_m  that the robot stands on
  [[nodiscard]] bool has_storey(double ground_m, double margin_m) const {
    return ground_m >= lowest_m - margin_m && ground_m <= highest_m + margin_m;
  }
};

/// By the names that people give them.
using MapRegions = std::map<std::string, MapRegion>;

/// map.regions.yaml beside map.pcd.
std::filesystem::path map_regions_file(const std::filesystem::path& pcd_file);

/// Of that file; none if there is no such file.
/// @throws ConfigError that names file, line and key
MapRegions load_map_regions(const std::filesystem::path& pcd_file);

MapRegions read_map_regions(ConfigReader regions);

}  // namespace fleetloc
