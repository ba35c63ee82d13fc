#pragma once

#include <Eigen/Core>

#include "cloud/laser_map/laser_map.hpp"
#include "cloud/locate/map_pyramid.hpp"
#include "shared/config/config_reader.hpp"

namespace fleetloc {

/// What was seen was seen through free space: a ray that passes through a surface of the map speaks
/// against the place that it was put to.
class FreeSpace {
 public:
  struct Config {
    double margin_m;       ///< before the landmark, which lies on a surface
    double min_planarity;  ///< of the surfaces: leaves and grass let rays through
    double min_incidence;  ///< sine of the angle to a surface; the others graze it
    double reach_m;        ///< from a point of the map its surface extends so far
  };

  /// @param map,pyramid  of the same points; outlive this
  FreeSpace(const LaserMap& map, const MapPyramid& pyramid, const Config& config)
      : map_(map), pyramid_(pyramid), config_(config) {}

  /// Whether a surface of the map that is not level stands between them.
  /// @param sigma_m  of the landmark along the ray
  [[nodiscard]] bool is_blocked(const Eigen::Vector3d& viewpoint_map,
                                const Eigen::Vector3d& landmark_map,
                                double sigma_m) const;

 private:
  struct Ray;
  [[nodiscard]] bool has_surface(const Eigen::Vector3d& p_map) const;
  [[nodiscard]] bool is_crossed(const Ray& ray, double along_m) const;

  const LaserMap& map_;
  const MapPyramid& pyramid_;
  Config config_;
};

FreeSpace::Config read_free_space_config(ConfigReader section);

}  // namespace fleetloc
