#include "robot/pipeline/robot_pipeline.hpp"
#include "robot/vio/vio_config.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/geometry/angle.hpp"

namespace fleetloc {

RobotPipeline::Config read_robot_pipeline_config(ConfigReader config) {
  const VioConfig vio = read_vio_config(config.section("vio"));
  ConfigReader start = config.section("start");
  return {.tracking = read_feature_tracker_config(config.section("tracking")),
          .initializer = vio.initializer,
          .frame_estimator = vio.frame_estimator,
          .health = read_odometry_health_config(config.section("health")),
          .fusion = read_pose_fusion_config(config.section("fusion")),
          .start = {.position_sigma_m = start.positive("position_sigma_m"),
                    .yaw_sigma_rad = start.positive("yaw_sigma_deg") * kRadPerDeg,
                    .tilt_sigma_rad = start.positive("tilt_sigma_deg") * kRadPerDeg,
                    .max_carried_sigma_m = start.positive("max_carried_sigma_m")}};
}

KeyframeWorker::Config read_keyframe_worker_config(ConfigReader config) {
  return {.window = read_vio_config(config.section("vio")).window,
          .submap = read_submap_builder_config(config.section("submap"))};
}

}  // namespace fleetloc
