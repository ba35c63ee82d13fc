#pragma once

#include <filesystem>
#include <string>

#include "shared/model/camera.hpp"
#include "shared/model/inertial.hpp"

namespace fleetloc {

/// sensor.yaml of a camera. The frame that poses are stated in is called `rig` here: EuRoC's body.
struct CameraFile {
  Camera camera;
  Pose T_rig_cam;
  double rate_hz = 0.0;
};

/// sensor.yaml of an IMU.
struct ImuFile {
  ImuNoise noise;
  Pose T_rig_imu;
  double rate_hz = 0.0;
};

/// A rotating lidar on the body. A revolution has `columns` firings, in each of which all rings
/// measure at once.
struct LidarCalibration {
  Pose T_body_lidar;
  double rate_hz = 0.0;  ///< revolutions
  int columns = 0;       ///< at most 65536
  int rings = 0;         ///< at most 256

  /// From the start of a scan to one of its columns.
  [[nodiscard]] double column_time_s(int column) const {
    return static_cast<double>(column) / (rate_hz * columns);
  }
};

/// With or without the line `%YAML:1.0` that OpenCV writes and YAML does not know. Throw
/// DatasetError.
CameraFile read_camera_file(const std::filesystem::path& file);
ImuFile read_imu_file(const std::filesystem::path& file);
/// Its rig is the body.
LidarCalibration read_lidar_file(const std::filesystem::path& file);

/// The same as text, with numbers that are read back exactly.
std::string camera_file_text(const CameraFile& file);
std::string imu_file_text(const ImuFile& imu);
std::string lidar_file_text(const LidarCalibration& lidar);

}  // namespace fleetloc
