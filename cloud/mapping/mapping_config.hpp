#pragma once

#include <cstddef>

#include "shared/config/config_reader.hpp"
#include "shared/core/time.hpp"

namespace fleetloc {

/// When a session's rays speak for or against what stands in a cell.
struct EvidenceConfig {
  double cell_m = 0.0;            ///< edge; what is in a cell stays or goes together
  int scan_stride = 1;            ///< the rays of every so many scans look through cells
  double min_margin_m = 0.0;      ///< a ray shows as free what is this far before its end, ...
  double surface_margin_m = 0.0;  ///< ... and this far off the surface that it hit
  double min_cosine = 0.0;        ///< of ray and normal; more grazing rays tell nothing of a sheet
  /// Of a ray from the middle of what it looks through, in standard deviations of its points.
  double max_sigmas_off_sheet = 0.0;
  double max_sigmas_off_stake = 0.0;
  int min_looks = 1;           ///< scans that looked through, for a session to say so
  double min_hit_share = 0.0;  ///< of all looks; a session with fewer hits contradicts
  double min_agreement = 0.0;  ///< share of the sessions that looked at a kept cell
  int min_sessions = 1;        ///< that have seen a kept cell
};

/// How scans become points of a map.
struct MappingConfig {
  double voxel_m = 0.0;        ///< edge; each voxel becomes the mean of its points
  std::size_t max_voxels = 0;  ///< beyond, the edge doubles
  double min_range_m = 0.0;    ///< nearer points are left out, ...
  double max_range_m = 0.0;    ///< ... and farther ones
  Duration max_gap{};          ///< between poses
  EvidenceConfig evidence;
};

/// Of the sections `map` and `mapping`. Throws ConfigError.
MappingConfig read_mapping_config(ConfigReader config);

}  // namespace fleetloc
