#pragma once

#include "deploy/sim/sensors/stereo_renderer.hpp"
#include "shared/model/camera.hpp"

namespace fleetloc {

/// 640 x 400, 90 degrees wide, 12 cm apart; left with radial-tangential, right with equidistant
/// distortion.
inline StereoCalibration campus_cameras() {
  StereoCalibration calibration;
  calibration.cam0 = {.width_px = 640,
                      .height_px = 400,
                      .focal_px = {330.0, 331.0},
                      .center_px = {322.0, 198.0},
                      .distortion = Camera::Distortion::kRadialTangential,
                      .coefficients = {-0.12, 0.02, 4e-4, -3e-4}};
  calibration.cam1 = {.width_px = 640,
                      .height_px = 400,
                      .focal_px = {328.0, 328.5},
                      .center_px = {317.0, 203.0},
                      .distortion = Camera::Distortion::kEquidistant,
                      .coefficients = {-0.02, 0.005, -0.002, 3e-4}};
  calibration.T_body_cam0.p = {-0.06, 0.0, 0.02};
  calibration.T_body_cam1.p = {0.06, 0.001, 0.02};
  return calibration;
}

inline StereoRenderer::Config camera_settings(int threads) {
  return {
      .threads = threads,
      .exposure = {.target_gray = 105.0F, .lag_s = 0.4F, .min_gain = 20.0F, .max_gain = 4000.0F},
      .noise = {.read_gray = 0.8F, .shot_gray = 0.01F, .reference_gain = 250.0F},
      .corner_loss = 0.2F,
      .exposure_time_s = 0.004F,
      .motion_samples = 1,
      .smooth_edges = true};
}

}  // namespace fleetloc
