#pragma once

#include <filesystem>

#include "robot/calibration/sensor_rig.hpp"

namespace fleetloc {

/// What Kalibr's calibration of cameras and IMU writes.
struct KalibrFiles {
  std::filesystem::path camchain;  ///< camchain-imucam.yaml
  std::filesystem::path imu;       ///< imu.yaml, with its values at the top or below `imu0`
};

/// Two cameras may have clocks that differ by this: it is below what pairing tolerates, and is
/// taken as noise of the calibration.
inline constexpr double kMaxTimeShiftDifference_s = 1e-3;

/// Pinhole cameras cam0 and cam1 with distortion radtan, equidistant or none. T_cn_cnm1, where it
/// is given, must agree with T_cam_imu; T_i_b and time_offset of the IMU must be none, since
/// T_cam_imu refers to it. timeshift_cam_imu (t_imu = t_cam + shift) becomes camera_time_shift, the
/// mean of both cameras; they may differ by kMaxTimeShiftDifference_s. Other keys are left alone:
/// the files are Kalibr's.
///
/// Throws ConfigError that names file, line and reason.
SensorRig read_kalibr_rig(const KalibrFiles& files);

}  // namespace fleetloc
