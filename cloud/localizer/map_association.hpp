#pragma once

#include <vector>

#include "cloud/laser_map/laser_map.hpp"
#include "cloud/localizer/map_match.hpp"
#include "cloud/localizer/nearest_neighbor_cache.hpp"
#include "shared/config/config_reader.hpp"

namespace fleetloc {

struct AssociationConfig {
  double plane_sigma_m;         ///< map noise and association error along a plane's normal
  double point_sigma_m;         ///< the same where the surroundings are not planar
  double min_planarity;         ///< of the map point, see MapPoint: from here on point to plane
  double level_from;            ///< vertical part of a unit normal; above it a surface is level
  double max_landmark_sigma_m;  ///< a landmark less certain than this is not matched
  double gate_sigmas;           ///< standard deviations within which a match must lie
  double coverage_radius_m;     ///< a landmark with map points within this is covered
  double cell_m;                ///< edge of the cells over which map information is capped
  double matches_per_cell;      ///< this many count fully; more share their information
};

struct Association {
  std::vector<MapMatch> matches;  ///< increasing by landmark
  int eligible = 0;               ///< landmarks known well enough
  int covered = 0;                ///< of these, with the map around them
  int level = 0;                  ///< of the matches, on level surfaces
  int occluded = 0;               ///< unmatched, and behind a surface of the map
  int below_ground = 0;           ///< of these, below level ground

  /// Without level surfaces, which constrain height only and match at any horizontal position.
  [[nodiscard]] int informative_matches() const { return static_cast<int>(matches.size()) - level; }
  [[nodiscard]] int informative_landmarks() const { return eligible - level; }
};

/// Pairs landmarks with the nearest map point within `gate_m`, widened by the landmark's own
/// uncertainty. While the gate is wide, the matches' sigmas are widened to a quarter of it.
Association associate(const std::vector<WindowLandmark>& landmarks,
                      const LaserMap& map,
                      double gate_m,
                      const AssociationConfig& config);
/// The same with the nearest neighbours of earlier calls.
Association associate(const std::vector<WindowLandmark>& landmarks,
                      const LaserMap& map,
                      double gate_m,
                      const AssociationConfig& config,
                      NearestNeighborCache& cache);

/// Point to plane (paper, eq. 14), signed, or point to point (eq. 13), the distance [m].
double residual(const MapMatch& match, const Eigen::Vector3d& p_map);

AssociationConfig read_association_config(ConfigReader section);

}  // namespace fleetloc
