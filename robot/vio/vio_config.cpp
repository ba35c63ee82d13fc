#include "robot/vio/vio_config.hpp"

namespace fleetloc {

VioConfig read_vio_config(ConfigReader section) {
  const VioNoise noise = read_vio_noise(section.section("noise"));
  VioConfig config;
  config.window = read_sliding_window_config(section.section("window"), noise);
  config.initializer = read_initializer_config(section.section("initializer"), config.window);
  config.frame_estimator = read_frame_estimator_config(section.section("frame"), noise);
  return config;
}

}  // namespace fleetloc
