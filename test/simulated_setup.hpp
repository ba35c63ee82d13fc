#pragma once

#include <string>

#include "deploy/config/default_config.hpp"
#include "deploy/sim/room/simulated_run.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/model/camera.hpp"

namespace fleetloc {

inline ConfigReader defaults() {
  return ConfigReader::from_string(std::string(default_config("everything")), "defaults");
}

/// Cameras without distortion whose rectified pair is `stereo`.
inline StereoCalibration ideal_cameras(const RectifiedStereo& stereo) {
  StereoCalibration calibration;
  calibration.cam0.width_px = 752;
  calibration.cam0.height_px = 480;
  calibration.cam0.focal_px.setConstant(stereo.focal_px);
  calibration.cam0.center_px = {376.0, 240.0};
  calibration.cam1 = calibration.cam0;
  calibration.T_body_cam0 = stereo.T_body_cam0;
  calibration.T_body_cam1 =
      stereo.T_body_cam0 * Pose{Eigen::Quaterniond::Identity(), {stereo.baseline_m, 0.0, 0.0}};
  return calibration;
}

/// A flight with all sources of noise, after a second at rest.
inline SimulatedRun::Config noisy_flight() {
  SimulatedRun::Config config;
  config.imu_white_noise = true;
  config.imu_bias_walk = true;
  config.initial_bias = {{0.01, -0.02, 0.03}, {0.05, -0.03, 0.02}};
  config.pixel_sigma = 0.3;
  config.rest_s = 1.0;
  return config;
}

}  // namespace fleetloc
