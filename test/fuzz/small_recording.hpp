#pragma once

#include <filesystem>

#include "shared/dataset/sensor_file.hpp"
#include "test/fuzz/input_files.hpp"

namespace fleetloc {

/// A folder mav0 with the calibrations of two cameras side by side and an IMU; each camera has
/// files for two images.
inline std::filesystem::path small_recording() {
  const auto mav0 = test_folder() / "mav0";
  if (std::filesystem::exists(mav0)) return mav0;
  for (const char* folder : {"cam0/data", "cam1/data", "imu0", "tracks0"}) {
    std::filesystem::create_directories(mav0 / folder);
  }
  CameraFile camera{.camera = {.width_px = 752,
                               .height_px = 480,
                               .focal_px = {458.0, 457.0},
                               .center_px = {367.0, 248.0}},
                    .T_rig_cam = {},
                    .rate_hz = 20.0};
  input_file("mav0/cam0/sensor.yaml", camera_file_text(camera));
  camera.T_rig_cam.p.x() = 0.11;
  input_file("mav0/cam1/sensor.yaml", camera_file_text(camera));
  input_file("mav0/imu0/sensor.yaml",
             imu_file_text({.noise = {.gyroscope_noise_density = 1e-4,
                                      .gyroscope_random_walk = 1e-5,
                                      .accelerometer_noise_density = 1e-3,
                                      .accelerometer_random_walk = 1e-4},
                            .T_rig_imu = {},
                            .rate_hz = 200.0}));
  for (const char* image : {"cam0/data/1.png", "cam0/data/2.png", "cam1/data/1.png"}) {
    input_file("mav0/" + std::string(image), "");
  }
  return mav0;
}

}  // namespace fleetloc
