#include "robot/odometry/visual_inertial_odometry.hpp"
#include "robot/vio/vio_config.hpp"
#include "shared/config/config_reader.hpp"

namespace fleetloc {

Duration max_imu_step(const VisualInertialOdometry::Config& config) {
  return from_seconds(config.frame_estimator.noise.imu_gaps.void_from_s);
}

VisualInertialOdometry::Config read_odometry_config(ConfigReader config) {
  const VioConfig vio = read_vio_config(config.section("vio"));
  ConfigReader standstill = config.section("standstill");
  return {.tracking = read_feature_tracker_config(config.section("tracking")),
          .initializer = vio.initializer,
          .frame_estimator = vio.frame_estimator,
          .health = read_odometry_health_config(config.section("health")),
          .standstill = read_standstill_config(standstill),
          .holds_without_place = from_seconds(standstill.positive("without_place_s"))};
}

KeyframeWorker::Config read_keyframe_worker_config(ConfigReader config) {
  return {.window = read_vio_config(config.section("vio")).window,
          .submap = read_submap_builder_config(config.section("submap"))};
}

}  // namespace fleetloc
