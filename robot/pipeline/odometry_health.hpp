#pragma once

#include <optional>
#include <string_view>

#include "robot/vio/frame_estimator.hpp"
#include "robot/vio/window_estimate.hpp"
#include "shared/config/config_reader.hpp"

namespace fleetloc {

/// Why the odometry had to start anew.
enum class ResetCause {
  kImuGap,           ///< longer than preintegration can bridge
  kDiverged,         ///< an optimization failed, or a speed is beyond all reason
  kImplausibleBias,  ///< of the IMU: it explains what it should not
  kVisionLost,       ///< no image has agreed with the inertial prediction for too long
  kUncertain,        ///< the velocity is hardly known any more
};

/// As it stands in files, e.g. "implausible_bias".
std::string_view name(ResetCause cause);

/// Tells what inertial prediction carries the odometry over (some bad images) from what it does
/// not.
class OdometryHealth {
 public:
  struct Config {
    double max_vision_lost_s = 0.0;       ///< without an image that the prediction agrees with
    double max_velocity_sigma = 0.0;      ///< each axis [m/s]
    double max_speed = 0.0;               ///< [m/s]
    double max_gyroscope_bias = 0.0;      ///< [rad/s]
    double max_accelerometer_bias = 0.0;  ///< [m/s^2]
  };
  explicit OdometryHealth(const Config& config) : config_(config) {}

  /// Of the latest optimization; the first one of a session begins it.
  std::optional<ResetCause> check(const WindowEstimate& window);

  /// Of one frame; between windows.
  std::optional<ResetCause> check(const FrameEstimator::Result& frame);

  /// The odometry starts anew.
  void reset() { last_vision_update_.reset(); }

 private:
  Config config_;
  std::optional<Timestamp> last_vision_update_;
};

OdometryHealth::Config read_odometry_health_config(ConfigReader section);

}  // namespace fleetloc
