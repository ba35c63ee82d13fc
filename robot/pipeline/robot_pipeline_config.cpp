#include "robot/pipeline/robot_pipeline.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/geometry/angle.hpp"

namespace fleetloc {

RobotPipeline::Config read_robot_pipeline_config(ConfigReader config) {
  ConfigReader start = config.section("start");
  return {.odometry = read_odometry_config(config),
          .fusion = read_pose_fusion_config(config.section("fusion")),
          .start = {.position_sigma_m = start.positive("position_sigma_m"),
                    .yaw_sigma_rad = start.positive("yaw_sigma_deg") * kRadPerDeg,
                    .tilt_sigma_rad = start.positive("tilt_sigma_deg") * kRadPerDeg,
                    .max_carried_sigma_m = start.positive("max_carried_sigma_m")}};
}

}  // namespace fleetloc
