#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <gmock/gmock.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "deploy/config/default_config.hpp"
#include "deploy/sim/sensors/stereo_renderer.hpp"
#include "test/unit/sensors/campus_cameras.hpp"
#include "test/unit/world/campus.hpp"

namespace fleetloc {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

const SeasonScene& autumn() {
  static const WorldConfig world = campus();
  static const Scene scene = build_scene(world.scene, eight(), 1);
  static const SeasonScene only = season_of(world, scene, "autumn");
  return only;
}

/// What is seen, without what an exposure, noise and a lens add to it.
StereoRenderer::Config plain_settings() {
  StereoRenderer::Config config = camera_settings(2);
  config.exposure.min_gain = 250.0F;
  config.exposure.max_gain = 250.0F;
  config.noise = {.read_gray = 0.0F, .shot_gray = 0.0F, .reference_gain = 250.0F};
  config.corner_loss = 0.0F;
  config.smooth_edges = false;
  return config;
}

constexpr double kTime_s = 5.0;

cv::Mat left_image(const StereoCalibration& cameras,
                   const StereoRenderer::Config& config,
                   const StereoRenderer::Motion& T_map_body,
                   double time_s = kTime_s) {
  StereoRenderer renderer(cameras, autumn(), config, 1);
  return renderer.render({.stamp = {}, .time_s = time_s, .frame = 0}, T_map_body).left;
}

/// Drives 4 m/s and turns.
Pose T_map_body_at(double time_s) {
  const double after_s = time_s - kTime_s;
  Pose T = T_map_body_on_eight(0.3, 1.5 * after_s);
  T.p += T.R * Eigen::Vector3d(0.0, 0.0, 4.0 * after_s);
  return T;
}

TEST(MotionBlur, IsTheMeanOverTheExposure) {
  StereoRenderer::Config config = plain_settings();
  config.exposure_time_s = 0.03F;
  config.motion_samples = 3;
  const cv::Mat blurred = left_image(campus_cameras(), config, T_map_body_at);
  config.motion_samples = 1;
  cv::Mat sum(blurred.size(), CV_32FC1, cv::Scalar(0.0));
  for (const double offset_s : {-0.01, 0.0, 0.01}) {
    const cv::Mat sharp = left_image(campus_cameras(), config, T_map_body_at, kTime_s + offset_s);
    cv::accumulate(sharp, sum);
  }
  cv::Mat mean;
  sum.convertTo(mean, CV_8UC1, 1.0 / 3.0);
  const cv::Mat sharp = left_image(campus_cameras(), config, T_map_body_at);
  EXPECT_LE(cv::norm(blurred, mean, cv::NORM_INF), 1.0);  // each image is rounded
  EXPECT_GT(cv::norm(blurred, sharp, cv::NORM_L1) / static_cast<double>(sharp.total()), 3.0);
}

TEST(MotionBlur, IsNotThereWhileTheCameraStands) {
  StereoRenderer::Config config = plain_settings();
  config.exposure_time_s = 0.002F;  // people walk on for 2 mm
  const auto standing = [](double) { return T_map_body_on_eight(0.3); };
  const cv::Mat sharp = left_image(campus_cameras(), config, standing);
  config.motion_samples = 4;
  const cv::Mat blurred = left_image(campus_cameras(), config, standing);
  EXPECT_LT(cv::norm(blurred, sharp, cv::NORM_L1) / static_cast<double>(sharp.total()), 0.05);
}

/// Half as many pixels each way, or `fineness` times as many as that; the same field of view.
StereoCalibration small_cameras(int fineness) {
  StereoCalibration cameras = campus_cameras();
  for (Camera* camera : {&cameras.cam0, &cameras.cam1}) {
    camera->width_px = 320 * fineness;
    camera->height_px = 200 * fineness;
    const double scale = 0.5 * fineness;
    camera->focal_px *= scale;
    // The middle of the first pixel is at zero.
    camera->center_px = (scale * (camera->center_px.array() + 0.5) - 0.5).matrix();
  }
  return cameras;
}

TEST(SmoothEdges, ComeNearerToWhatTheWholePixelSees) {
  const auto standing = [](double) { return T_map_body_on_eight(0.3); };
  StereoRenderer::Config config = plain_settings();
  const cv::Mat plain = left_image(small_cameras(1), config, standing);
  cv::Mat truth;
  cv::resize(left_image(small_cameras(4), config, standing),
             truth,
             plain.size(),
             0.0,
             0.0,
             cv::INTER_AREA);
  config.smooth_edges = true;
  const cv::Mat smooth = left_image(small_cameras(1), config, standing);
  int changed = 0;
  double plain_error = 0.0;
  double smooth_error = 0.0;
  for (int v = 0; v < plain.rows; ++v) {
    for (int u = 0; u < plain.cols; ++u) {
      const int as_is = plain.at<std::uint8_t>(v, u);
      const int smoothed = smooth.at<std::uint8_t>(v, u);
      const int wanted = truth.at<std::uint8_t>(v, u);
      if (std::abs(as_is - smoothed) < 3) continue;
      ++changed;
      plain_error += std::abs(as_is - wanted);
      smooth_error += std::abs(smoothed - wanted);
    }
  }
  std::printf("%d pixels: %.1f gray values from the truth, smoothed %.1f\n",
              changed,
              plain_error / changed,
              smooth_error / changed);
  EXPECT_GT(changed, 500);
  EXPECT_LT(smooth_error, 0.75 * plain_error);
}

ConfigReader renderer_section(const char* overlay = "{}") {
  auto reader = ConfigReader::from_string(default_config("sim"), "sim.yaml");
  reader.overlay(ConfigReader::from_string(overlay, "user.yaml"));
  return reader.section("sim").section("renderer");
}

TEST(StereoRendererConfig, ReadsEachKeyIntoItsPlace) {
  auto reader = ConfigReader::from_string(
      "renderer: {threads: 3, exposure: {target_gray: 90, lag_s: 0.1, min_gain: 2, max_gain: "
      "50},"
      " noise: {read_gray: 0.5, shot_gray: 0.25, reference_gain: 125}, corner_loss: 0.125,"
      " motion_blur: {exposure_time_s: 0.0625, samples: 5}, smooth_edges: false}",
      "sim.yaml");
  const StereoRenderer::Config config = read_stereo_renderer_config(reader.section("renderer"));
  EXPECT_NO_THROW(reader.expect_fully_read());
  EXPECT_EQ(config.threads, 3);
  EXPECT_EQ(config.exposure.target_gray, 90.0F);
  EXPECT_EQ(config.exposure.lag_s, 0.1F);
  EXPECT_EQ(config.exposure.min_gain, 2.0F);
  EXPECT_EQ(config.exposure.max_gain, 50.0F);
  EXPECT_EQ(config.noise.read_gray, 0.5F);
  EXPECT_EQ(config.noise.shot_gray, 0.25F);
  EXPECT_EQ(config.noise.reference_gain, 125.0F);
  EXPECT_EQ(config.corner_loss, 0.125F);
  EXPECT_EQ(config.exposure_time_s, 0.0625F);
  EXPECT_EQ(config.motion_samples, 5);
  EXPECT_FALSE(config.smooth_edges);
}

TEST(StereoRendererConfig, DefaultsHaveNoMotionBlur) {
  EXPECT_EQ(read_stereo_renderer_config(renderer_section()).motion_samples, 1);
}

TEST(StereoRendererConfig, RefusesWhatMakesNoSenseByItsName) {
  const auto expect_refused = [](const char* renderer, const char* key) {
    const std::string yaml = std::string("sim: {renderer: ") + renderer + "}";
    EXPECT_THAT(
        [&] { static_cast<void>(read_stereo_renderer_config(renderer_section(yaml.c_str()))); },
        ThrowsMessage<ConfigError>(HasSubstr(key)))
        << yaml;
  };
  expect_refused("{threads: 0}", "user.yaml:1: sim.renderer.threads");
  expect_refused("{exposure: {min_gain: 0}}", "sim.renderer.exposure.min_gain");
  expect_refused("{noise: {shot_gray: -1}}", "sim.renderer.noise.shot_gray");
  expect_refused("{corner_loss: 1.5}", "sim.renderer.corner_loss");
  expect_refused("{motion_blur: {samples: 0}}", "sim.renderer.motion_blur.samples");
  expect_refused("{motion_blur: {exposure_time_s: 2}}", "sim.renderer.motion_blur.exposure_time_s");
  expect_refused("{smooth_edges: perhaps}", "sim.renderer.smooth_edges");
}

}  // namespace
}  // namespace fleetloc
