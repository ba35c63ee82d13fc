#include "robot/vio/vio_noise.hpp"

namespace fleetloc {
namespace {

ImuGapModel read_imu_gap_model(ConfigReader section) {
  ImuGapModel model;
  model.bridged_from_s = section.positive("bridged_from_s");
  model.angular_acceleration = section.positive("angular_acceleration");
  model.jerk = section.positive("jerk");
  model.void_from_s = section.positive("void_from_s");
  model.speed_sigma = section.positive("speed_sigma");
  model.turn_rate_sigma = section.positive("turn_rate_sigma");
  return model;
}

}  // namespace

VioNoise read_vio_noise(ConfigReader section) {
  VioNoise noise;
  noise.pixel_sigma = section.positive("pixel_sigma");
  noise.imu_white_factor = section.positive("imu_white_factor");
  noise.imu_walk_factor = section.positive("imu_walk_factor");
  noise.imu_gaps = read_imu_gap_model(section.section("imu_gaps"));
  return noise;
}

ImuNoise inflated(const ImuNoise& noise, const VioNoise& factors) {
  return {factors.imu_white_factor * noise.gyroscope_noise_density,
          factors.imu_walk_factor * noise.gyroscope_random_walk,
          factors.imu_white_factor * noise.accelerometer_noise_density,
          factors.imu_walk_factor * noise.accelerometer_random_walk,
          factors.imu_gaps};
}

}  // namespace fleetloc
