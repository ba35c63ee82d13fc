#pragma once

#include <cstddef>

#include "shared/config/config_reader.hpp"
#include "shared/core/time.hpp"

namespace fleetloc {

/// When the rays of a session confirm or contradict the surface in a cell.
struct EvidenceConfig {
  double cell_m = 0.0;            ///< edge; the points of a cell are kept or dropped together
  int scan_stride = 1;            ///< every n-th scan is traced for misses
  double min_margin_m = 0.0;      ///< a ray is free up to this far before its end, ...
  double surface_margin_m = 0.0;  ///< ... and this far off the surface that it hit
  double min_cosine = 0.0;        ///< of ray and normal; more grazing rays miss no plane
  /// Mahalanobis distance of a ray from the points of a cell that it misses, in sigmas.
  double max_planar_sigmas = 0.0;
  double max_nonplanar_sigmas = 0.0;
  int min_misses = 1;          ///< scans with a miss, for a session to contradict
  double min_hit_share = 0.0;  ///< of hits and misses; a session with fewer hits contradicts
  double min_agreement = 0.0;  ///< confirming share of the sessions that observed a kept cell
  int min_sessions = 1;        ///< that confirm a kept cell
};

/// How scans become points of a map.
struct MappingConfig {
  double voxel_m = 0.0;        ///< edge; each voxel becomes the mean of its points
  std::size_t max_voxels = 0;  ///< beyond, the edge doubles
  double min_range_m = 0.0;    ///< nearer points are left out, ...
  double max_range_m = 0.0;    ///< ... and farther ones
  Duration max_gap{};          ///< between poses; longer ones are not interpolated
  EvidenceConfig evidence;
};

/// Reads the sections `map` and `mapping`. Throws ConfigError.
MappingConfig read_mapping_config(ConfigReader config);

}  // namespace fleetloc
