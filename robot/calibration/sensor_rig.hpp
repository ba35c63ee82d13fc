#pragma once

#include "shared/core/time.hpp"
#include "shared/model/camera.hpp"
#include "shared/model/inertial.hpp"

namespace fleetloc {

/// What is known of a robot's cameras and IMU before they measure anything.
struct SensorRig {
  StereoCalibration cameras = {};
  ImuNoise imu_noise = {};
  double frame_rate_hz = 0.0;  ///< 0: unknown
  double imu_rate_hz = 0.0;    ///< 0: unknown
  /// The IMU's clock minus the cameras': to be added to the stamps of images.
  Duration camera_time_shift{};
};

}  // namespace fleetloc
