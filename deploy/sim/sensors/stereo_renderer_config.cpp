#include "deploy/sim/sensors/stereo_renderer.hpp"

namespace fleetloc {

StereoRenderer::Config read_stereo_renderer_config(ConfigReader section) {
  const auto number = [](ConfigReader& reader, const char* key, double least, double most) {
    return static_cast<float>(reader.number(key, least, most));
  };
  StereoRenderer::Config config{};
  config.threads = section.integer("threads", 1, 64);
  ConfigReader exposure = section.section("exposure");
  config.exposure = {.target_gray = number(exposure, "target_gray", 10.0, 240.0),
                     .lag_s = number(exposure, "lag_s", 0.0, 60.0),
                     .min_gain = number(exposure, "min_gain", 0.01, 1e6),
                     .max_gain = number(exposure, "max_gain", 0.01, 1e6)};
  ConfigReader noise = section.section("noise");
  config.noise = {.read_gray = number(noise, "read_gray", 0.0, 50.0),
                  .shot_gray = number(noise, "shot_gray", 0.0, 10.0),
                  .reference_gain = number(noise, "reference_gain", 0.01, 1e6)};
  config.corner_loss = number(section, "corner_loss", 0.0, 0.9);
  ConfigReader blur = section.section("motion_blur");
  config.exposure_time_s = number(blur, "exposure_time_s", 0.0, 0.1);
  config.motion_samples = blur.integer("samples", 1, 64);
  config.smooth_edges = section.get<bool>("smooth_edges");
  return config;
}

}  // namespace fleetloc
