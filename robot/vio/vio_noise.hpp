#pragma once

#include "shared/config/config_reader.hpp"
#include "shared/model/inertial.hpp"

namespace fleetloc {

/// Measurement noise for all of the VIO.
struct VioNoise {
  double pixel_sigma = 0.0;       ///< of u_left, v and u_right alike [px]
  double imu_white_factor = 0.0;  ///< on the noise densities of the IMU's sheet (vibration, ...)
  double imu_walk_factor = 0.0;   ///< on its random walks of the biases
  ImuGapModel imu_gaps = {};
};
VioNoise read_vio_noise(ConfigReader section);

/// `noise` with the factors applied.
ImuNoise inflated(const ImuNoise& noise, const VioNoise& factors);

}  // namespace fleetloc
