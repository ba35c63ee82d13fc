#include "robot/calibration/euroc_rig.hpp"

#include <stdexcept>

#include "shared/dataset/dataset_error.hpp"
#include "shared/dataset/sensor_file.hpp"

namespace fleetloc {

EurocFiles euroc_files(const std::filesystem::path& mav0) {
  return {.cam0 = mav0 / "cam0" / "sensor.yaml",
          .cam1 = mav0 / "cam1" / "sensor.yaml",
          .imu = mav0 / "imu0" / "sensor.yaml"};
}

SensorRig read_euroc_rig(const EurocFiles& files) {
  const CameraFile cam0 = read_camera_file(files.cam0);
  const CameraFile cam1 = read_camera_file(files.cam1);
  const ImuFile imu = read_imu_file(files.imu);
  const Pose T_body_rig = inverse(imu.T_rig_imu);
  SensorRig rig{.cameras = {.cam0 = cam0.camera,
                            .cam1 = cam1.camera,
                            .T_body_cam0 = T_body_rig * cam0.T_rig_cam,
                            .T_body_cam1 = T_body_rig * cam1.T_rig_cam},
                .imu_noise = imu.noise,
                .frame_rate_hz = cam0.rate_hz,
                .imu_rate_hz = imu.rate_hz};
  try {
    rectified(rig.cameras);
  } catch (const std::invalid_argument& error) {
    throw DatasetError(files.cam1.string() + ": T_BS: " + error.what());
  }
  return rig;
}

}  // namespace fleetloc
