#include "robot/vio/vio_noise.hpp"

namespace fleetloc {

VioNoise read_vio_noise(ConfigReader section) {
  VioNoise noise;
  noise.pixel_sigma = section.positive("pixel_sigma");
  noise.imu_white_factor = section.positive("imu_white_factor");
  noise.imu_walk_factor = section.positive("imu_walk_factor");
  return noise;
}

ImuNoise inflated(const ImuNoise& noise, const VioNoise& factors) {
  return {factors.imu_white_factor * noise.gyroscope_noise_density,
          factors.imu_walk_factor * noise.gyroscope_random_walk,
          factors.imu_white_factor * noise.accelerometer_noise_density,
          factors.imu_walk_factor * noise.accelerometer_random_walk};
}

}  // namespace fleetloc
