#include "robot/fusion/pose_fusion.hpp"

#include <string>

#include "robot/fusion/coupled_fusion.hpp"
#include "robot/fusion/decoupled_fusion.hpp"
#include "shared/geometry/angle.hpp"

namespace fleetloc {
namespace {

PoseFusion::Formulation read_formulation(ConfigReader& section) {
  const auto text = section.get<std::string>("formulation");
  if (text == "decoupled") {
    return PoseFusion::Formulation::kDecoupled;
  }
  if (text == "coupled") {
    return PoseFusion::Formulation::kCoupled;
  }
  throw ConfigError("fusion.formulation: must be decoupled or coupled, not '" + text + "'");
}

}  // namespace

std::unique_ptr<PoseFusion> make_pose_fusion(const ImuNoise& noise,
                                             const PoseFusion::Config& config) {
  if (config.formulation == PoseFusion::Formulation::kCoupled) {
    return std::make_unique<CoupledFusion>(noise, config);
  }
  return std::make_unique<DecoupledFusion>(noise, config);
}

PoseFusion::Config read_pose_fusion_config(ConfigReader section) {
  PoseFusion::Config config;
  config.formulation = read_formulation(section);
  config.buffer_s = section.positive("buffer_s");
  config.localized_below_m = section.positive("localized_below_m");
  config.localized_below_rad = kRadPerDeg * section.positive("localized_below_deg");
  config.localized_for_s = section.positive("localized_for_s");
  config.odometry_timeout_s = section.positive("odometry_timeout_s");
  config.lost_beyond_m = section.positive("lost_beyond_m");
  config.lost_beyond_rad = kRadPerDeg * section.positive("lost_beyond_deg");
  config.drift = read_odometry_drift_config(section.section("drift"));
  config.answers = read_map_alignment_config(section.section("answers"));
  return config;
}

}  // namespace fleetloc
