#pragma once

#include <filesystem>
#include <vector>

#include "shared/core/time.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

struct StampedCovariance {
  Timestamp stamp;
  Matrix6d covariance;  ///< right perturbation of the pose at stamp
};

/// The covariances that a run states; stamps strictly increase.
struct RunCovariances {
  std::vector<StampedCovariance> map;   ///< of T_map_body
  std::vector<StampedCovariance> odom;  ///< of T_odom_body
  std::vector<Timestamp> localized;     ///< frames whose state is `localized`
};

/// Reads the columns `stamp_s`, `state`, `cm11..cm66` and `co11..co66` of diagnostics.csv, wherever
/// they are. A frame without a pose has `nan` or nothing there. Throws TextFileError.
RunCovariances read_covariances(const std::filesystem::path& path);

}  // namespace fleetloc
