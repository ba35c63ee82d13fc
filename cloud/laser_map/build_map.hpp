#pragma once

#include <cstddef>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "cloud/laser_map/laser_map.hpp"
#include "shared/config/config_reader.hpp"

namespace fleetloc {

struct MapConfig {
  double resolution_m = 0.0;     ///< edge of the voxels; each becomes the mean of its points
  double normal_radius_m = 0.0;  ///< of the neighbourhood of which a normal is computed
  int min_neighbours = 0;        ///< with fewer points around it a point has no normal
  int threads = 1;               ///< that compute normals; the map is the same with any number
};

MapConfig read_map_config(ConfigReader section);

/// A rectangle along the axes of the map's frame, of any height [m].
struct MapArea {
  Eigen::Vector2d min;
  Eigen::Vector2d max;
};

/// The points that are not in it.
std::vector<Eigen::Vector3f> points_outside(std::vector<Eigen::Vector3f> points,
                                            const MapArea& area);

/// The same for another resolution: the normal radius scales with it.
MapConfig at_resolution(MapConfig config, double resolution_m);

/// The points do not make a map, see build_map().
class MapBuildError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Called with the number of points that have a normal so far, and of all points.
using MapProgress = std::function<void(std::size_t done, std::size_t total)>;

/// Voxel filter, then a normal and a planarity for each point by principal component analysis of
/// the points within a radius, itself included (MapPoint says what planarity means). Points that
/// are not finite are left out. Deterministic: the order of voxels is that of their coordinates.
/// Throws MapBuildError if nothing is left, or if a point is so far from the origin that a float
/// does not resolve a millimetre there.
/// @param points  in the frame called `frame` [m]
LaserMap build_map(const std::vector<Eigen::Vector3f>& points,
                   const std::string& frame,
                   const MapConfig& config,
                   const MapProgress& progress = {});

/// Share of the points with a planarity of `planarity` or more, 0..1.
double planar_share(const LaserMap& map, double planarity);

}  // namespace fleetloc
