#include <sstream>
#include <stdexcept>

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

ConfigReader start_sigma_config(const std::string& text) {
  std::istringstream stream(text);
  double position_m = 0.0;
  double yaw_deg = 0.0;
  std::string rest;
  if (!(stream >> position_m >> yaw_deg) || stream >> rest || !(position_m > 0.0) ||
      !(yaw_deg > 0.0)) {
    throw std::invalid_argument("'" + text + "' is no sigma: expected \"m deg\", both positive");
  }
  std::ostringstream yaml;
  yaml << "start: {position_sigma_m: " << position_m << ", yaw_sigma_deg: " << yaw_deg << "}";
  return ConfigReader::from_string(yaml.str(), "--initial-sigma");
}

StartRegion start_region(const std::string& text) {
  if (is_valid_id(text)) return {.name = text};
  std::istringstream stream(text);
  StartRegion circle;
  std::string rest;
  if (!(stream >> circle.center_map.x() >> circle.center_map.y() >> circle.radius_m) ||
      stream >> rest || !(circle.radius_m > 0.0)) {
    throw std::invalid_argument("'" + text +
                                "' is no region: expected a name, or \"x y radius\" in m");
  }
  return circle;
}

}  // namespace fleetloc
