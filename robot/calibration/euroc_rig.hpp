#pragma once

#include <filesystem>

#include "robot/calibration/sensor_rig.hpp"

namespace fleetloc {

/// The `sensor.yaml` of both cameras and of the IMU.
struct EurocFiles {
  std::filesystem::path cam0;
  std::filesystem::path cam1;
  std::filesystem::path imu;
};

/// Those of a recording.
/// @param mav0  that holds cam0, cam1 and imu0
EurocFiles euroc_files(const std::filesystem::path& mav0);

/// The body is the IMU, whatever frame the files state their poses in. Throws DatasetError, also
/// for cameras that do not stand side by side.
SensorRig read_euroc_rig(const EurocFiles& files);

}  // namespace fleetloc
