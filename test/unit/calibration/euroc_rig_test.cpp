#include "robot/calibration/euroc_rig.hpp"

#include <fstream>

#include <gmock/gmock.h>

#include "shared/dataset/dataset_error.hpp"
#include "shared/dataset/sensor_file.hpp"
#include "shared/geometry/so3.hpp"
#include "test/test_folder.hpp"

namespace fleetloc {
namespace {

using ::testing::HasSubstr;

EurocFiles written(const Pose& T_cam0_cam1) {
  const EurocFiles files = euroc_files(test_folder());
  for (const auto& file : {files.cam0, files.cam1, files.imu}) {
    std::filesystem::create_directories(file.parent_path());
  }
  CameraFile camera{.camera = {.width_px = 640,
                               .height_px = 480,
                               .focal_px = {300.0, 300.0},
                               .center_px = {320.0, 240.0},
                               .distortion = Camera::Distortion::kEquidistant,
                               .coefficients = {0.01, 0.0, 0.0, 0.0}},
                    .T_rig_cam = {.R = exp_so3({0.0, 1.2, 0.3}), .p = {0.1, 0.2, 0.3}},
                    .rate_hz = 20.0};
  std::ofstream(files.cam0) << camera_file_text(camera);
  camera.T_rig_cam = camera.T_rig_cam * T_cam0_cam1;
  std::ofstream(files.cam1) << camera_file_text(camera);
  const ImuFile imu{.noise = {1e-4, 1e-5, 1e-3, 1e-4},
                    .T_rig_imu = {.R = exp_so3({0.5, 0.0, 0.0}), .p = {0.0, 0.1, 0.0}},
                    .rate_hz = 200.0};
  std::ofstream(files.imu) << imu_file_text(imu);
  return files;
}

TEST(EurocRig, StatesTheCamerasInTheFrameOfTheImu) {
  const Pose T_cam0_cam1{.R = Eigen::Quaterniond::Identity(), .p = {0.1, 0.0, 0.0}};
  const SensorRig rig = read_euroc_rig(written(T_cam0_cam1));
  const Pose T_rig_imu{.R = exp_so3({0.5, 0.0, 0.0}), .p = {0.0, 0.1, 0.0}};
  const Pose T_rig_cam0{.R = exp_so3({0.0, 1.2, 0.3}), .p = {0.1, 0.2, 0.3}};
  EXPECT_LT(local_coordinates(rig.cameras.T_body_cam0, inverse(T_rig_imu) * T_rig_cam0).norm(),
            1e-12);
  EXPECT_NEAR(rectified(rig.cameras).baseline_m, 0.1, 1e-12);
  EXPECT_EQ(rig.frame_rate_hz, 20.0);
  EXPECT_EQ(rig.imu_rate_hz, 200.0);
  EXPECT_EQ(rig.camera_time_shift, Duration{});
}

TEST(EurocRig, IsRefusedWithoutABaseline) {
  try {
    read_euroc_rig(written({}));
    FAIL() << "no error";
  } catch (const DatasetError& error) {
    EXPECT_THAT(error.what(), HasSubstr("cam1/sensor.yaml: T_BS: stereo calibration"));
  }
}

}  // namespace
}  // namespace fleetloc
