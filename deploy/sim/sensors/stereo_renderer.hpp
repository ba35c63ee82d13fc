#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "deploy/sim/sensors/camera_packet.hpp"
#include "deploy/sim/sensors/light.hpp"
#include "deploy/sim/sensors/pixel_block.hpp"
#include "deploy/sim/sensors/sensor_response.hpp"
#include "deploy/sim/sensors/shaded_image.hpp"
#include "deploy/sim/sensors/view_rays.hpp"
#include "deploy/sim/world/season_scene.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/core/time.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/model/camera.hpp"
#include "shared/model/stereo_frame.hpp"

namespace fleetloc {

/// Images of a stereo camera in a season of the world, exact in geometry: one ray through the
/// center of each pixel, by the camera's own model. The same bytes for one seed, however many
/// threads work.
class StereoRenderer {
 public:
  struct Config {
    int threads;
    Exposure::Config exposure;
    PixelResponse::Noise noise;
    float corner_loss;      ///< vignetting: loss of light in the corners, 0..1
    float exposure_time_s;  ///< of motion blur
    int motion_samples;     ///< over that time; 1: no motion blur
    bool smooth_edges;      ///< antialiasing, see smooth_edges()
  };

  /// `scene` must live as long.
  StereoRenderer(const StereoCalibration& calibration,
                 const SeasonScene& scene,
                 const Config& config,
                 std::uint64_t seed);

  struct Shot {
    Timestamp stamp;
    double time_s = 0.0;      ///< the same since the start of the season, for dynamic objects
    std::uint64_t frame = 0;  ///< its number, for the noise
  };
  using Motion = std::function<Pose(double time_s)>;  ///< T_map_body

  /// Both images, exposed about the shot's time. Shots must come in the order of their times: the
  /// exposure follows the brightness of those before.
  StereoFrame render(const Shot& shot, const Motion& T_map_body);

 private:
  struct SingleCamera {
    SingleCamera(const Camera& camera,
                 Pose T_body_camera,
                 const Config& config,
                 const CounterRandom& noise);

    ViewRays rays;
    std::vector<std::array<CameraPacket, PixelBlock::kPackets>> blocks;  // the same, by rows
    std::vector<float> vignetting;                                       // vignetting, by pixel
    Pose T_body_cam;
    PixelResponse response;
    ShadedImage image;
  };
  void expose(SingleCamera& camera, const Shot& shot, const Motion& T_map_body);
  void trace(SingleCamera& camera, const SceneView& view, const Pose& T_map_cam);
  [[nodiscard]] cv::Mat to_gray(const SingleCamera& camera, std::uint64_t frame, float gain) const;

  Config config_;
  const SeasonScene* scene_;
  Light light_;
  Exposure exposure_;
  std::array<SingleCamera, 2> cameras_;
};

/// Strict; throws ConfigError.
StereoRenderer::Config read_stereo_renderer_config(ConfigReader section);

}  // namespace fleetloc
