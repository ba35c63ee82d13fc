#pragma once

#include <cstdint>
#include <functional>

#include "cloud/mapping/lidar_scan.hpp"
#include "deploy/sim/motion/spline_motion.hpp"
#include "deploy/sim/world/ray_caster.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/dataset/sensor_file.hpp"

namespace fleetloc {

/// A lidar in the manner of the VLP-16.
struct LidarConfig {
  LidarCalibration calibration{.T_body_lidar = {}, .rate_hz = 10.0, .columns = 1800, .rings = 16};
  double lowest_rad = 0.0;         ///< elevation of ring 0; the others follow at equal angles
  double highest_rad = 0.0;        ///< of the last ring
  double range_sigma_m = 0.0;      ///< of each range, white
  double dropout_share = 0.0;      ///< of the returns, missing at random
  double min_m = 0.0;              ///< nearer surfaces give no return
  double max_m = 0.0;              ///< farther ones neither
  double max_incidence_rad = 0.0;  ///< between ray and normal; more grazing rays do not return
};

/// Throws ConfigError.
LidarConfig read_lidar_config(ConfigReader section);

/// A simulated lidar: the z axis is that of rotation, column 0 points along x, counter-clockwise.
/// Every ray is cast from the pose of its own time. Deterministic by the seed, whatever the order
/// of scans and the number of threads that call it.
class Lidar {
 public:
  Lidar(LidarConfig config, std::uint64_t seed);

  [[nodiscard]] const LidarConfig& config() const { return config_; }

  /// The revolution that begins at `time_s` of the motion.
  /// @param index  of the scan, which selects its noise
  /// @return       a scan with the stamp `start` + time_s
  [[nodiscard]] LidarScan scan(const RayCaster& world,
                               const SplineMotion& motion,
                               Timestamp start,
                               std::uint64_t index) const;

  /// When scan `index` begins, from the start of the motion [s].
  [[nodiscard]] double scan_time_s(std::uint64_t index) const;

 private:
  void measure_column(const RayCaster& world,
                      const Pose& T_map_lidar,
                      std::uint64_t index,
                      int column,
                      LidarScan& scan) const;

  LidarConfig config_;
  std::uint64_t seed_;
};

}  // namespace fleetloc
