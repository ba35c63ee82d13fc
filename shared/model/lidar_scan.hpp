#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "shared/core/time.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// A rotating lidar on the body. A revolution has `columns` moments, in each of which all rings
/// measure at once.
struct LidarCalibration {
  Pose T_body_lidar;
  double rate_hz = 0.0;  ///< revolutions
  int columns = 0;       ///< at most 65536
  int rings = 0;         ///< at most 256

  /// From the start of a scan to one of its columns.
  [[nodiscard]] double column_time_s(int column) const {
    return static_cast<double>(column) / (rate_hz * columns);
  }
};

struct LidarPoint {
  Eigen::Vector3f p_lidar = Eigen::Vector3f::Zero();  ///< in the lidar's frame of that moment [m]
  std::uint16_t column = 0;  ///< when: LidarCalibration::column_time_s() after the scan's stamp
  std::uint8_t ring = 0;     ///< from the lowest one
};

/// One revolution, as measured: the motion during the scan is still in it.
struct LidarScan {
  Timestamp stamp;                 ///< of column 0
  std::vector<LidarPoint> points;  ///< column by column, from the lowest ring
};

}  // namespace fleetloc
