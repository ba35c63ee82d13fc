#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "shared/core/time.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

struct LidarPoint {
  Eigen::Vector3f p_lidar = Eigen::Vector3f::Zero();  ///< in the lidar's frame at its own time [m]
  std::uint16_t column = 0;  ///< when: LidarCalibration::column_time_s() after the scan's stamp
  std::uint8_t ring = 0;     ///< from the lowest one
};

/// One revolution as measured, not deskewed.
struct LidarScan {
  Timestamp stamp;                 ///< of column 0
  std::vector<LidarPoint> points;  ///< column by column, from the lowest ring
};

}  // namespace fleetloc
