#pragma once

#include <optional>
#include <string_view>

#include "robot/vio/frame_estimator.hpp"
#include "robot/vio/window_estimate.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/core/expected.hpp"

namespace fleetloc {

/// Why the odometry was reset.
enum class ResetCause {
  kImuGap,           ///< longer than preintegration can bridge
  kDiverged,         ///< an optimization failed, or the speed is above its limit
  kImplausibleBias,  ///< of the IMU: above its limit
  kVisionLost,       ///< no image has agreed with the inertial prediction for too long
  kUncertain,        ///< the sigma of the velocity is above its limit
};

/// Name in files, e.g. "implausible_bias".
std::string_view name(ResetCause cause);

/// Decides whether inertial prediction bridges a fault (some bad images) or the odometry has to be
/// reset, and why.
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

  /// Checks the latest optimization; the first one of a session starts it.
  expected<void, ResetCause> check(const WindowEstimate& window);

  /// Checks one frame, between optimizations.
  expected<void, ResetCause> check(const FrameEstimator::Result& frame);

  /// The pose is known at this time without an image: the body stands still.
  void begin_anew(Timestamp stamp) { last_vision_update_ = stamp; }

  /// After a reset of the odometry.
  void reset() { last_vision_update_.reset(); }

 private:
  Config config_;
  std::optional<Timestamp> last_vision_update_;
};

OdometryHealth::Config read_odometry_health_config(ConfigReader section);

}  // namespace fleetloc
