#include "robot/calibration/kalibr_rig.hpp"

#include <fstream>
#include <string>

#include <gmock/gmock.h>

#include "shared/config/config_reader.hpp"
#include "test/test_folder.hpp"

namespace fleetloc {
namespace {

using ::testing::HasSubstr;

// cam0 looks along x of the IMU, its x axis to the IMU's -y; cam1 is 0.1 m to the right.
const std::string kChain = R"(cam0:
  T_cam_imu:
  - [0.0, -1.0, 0.0, 0.01]
  - [0.0, 0.0, -1.0, 0.02]
  - [1.0, 0.0, 0.0, 0.03]
  - [0.0, 0.0, 0.0, 1.0]
  cam_overlaps: [1]
  camera_model: pinhole
  distortion_coeffs: [0.0034823, 0.000715, -0.0020532, 0.0002029]
  distortion_model: equidistant
  intrinsics: [190.9, 191.4, 254.9, 256.8]
  resolution: [512, 512]
  rostopic: /cam0/image_raw
  timeshift_cam_imu: 0.0081
cam1:
  T_cam_imu:
  - [0.0, -1.0, 0.0, -0.09]
  - [0.0, 0.0, -1.0, 0.02]
  - [1.0, 0.0, 0.0, 0.03]
  - [0.0, 0.0, 0.0, 1.0]
  T_cn_cnm1:
  - [1.0, 0.0, 0.0, -0.1]
  - [0.0, 1.0, 0.0, 0.0]
  - [0.0, 0.0, 1.0, 0.0]
  - [0.0, 0.0, 0.0, 1.0]
  camera_model: pinhole
  distortion_coeffs: [-0.28, 0.07, 0.0002, 0.00001]
  distortion_model: radtan
  intrinsics: [191.9, 192.4, 253.9, 255.8]
  resolution: [640, 480]
  rostopic: /cam1/image_raw
  timeshift_cam_imu: 0.0083
)";

const std::string kImu = R"(rostopic: /imu0
update_rate: 200.0
accelerometer_noise_density: 0.0028
accelerometer_random_walk: 0.00086
gyroscope_noise_density: 0.00016
gyroscope_random_walk: 0.000022
)";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

/// In the second camera.
std::string replaced_last(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.rfind(from), from.size(), to);
}

SensorRig read(const std::string& chain, const std::string& imu = kImu) {
  const KalibrFiles files{.camchain = test_folder() / "camchain.yaml",
                          .imu = test_folder() / "imu.yaml"};
  std::ofstream(files.camchain) << chain;
  std::ofstream(files.imu) << imu;
  return read_kalibr_rig(files);
}

std::string error_of(const std::string& chain, const std::string& imu = kImu) {
  try {
    read(chain, imu);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

TEST(KalibrRig, HasBothCamerasAndTheImuAsTheFilesSay) {
  const SensorRig rig = read(kChain);
  const StereoCalibration& cameras = rig.cameras;
  EXPECT_EQ(cameras.cam0.distortion, Camera::Distortion::kEquidistant);
  EXPECT_EQ(cameras.cam0.coefficients, Eigen::Vector4d(0.0034823, 0.000715, -0.0020532, 0.0002029));
  EXPECT_EQ(cameras.cam0.focal_px, Eigen::Vector2d(190.9, 191.4));
  EXPECT_EQ(cameras.cam1.distortion, Camera::Distortion::kRadialTangential);
  EXPECT_EQ(cameras.cam1.width_px, 640);
  EXPECT_EQ(cameras.cam1.height_px, 480);
  // What is in front of cam0 is along x of the body.
  const Eigen::Vector3d p_body = cameras.T_body_cam0 * Eigen::Vector3d(0.01, 0.02, 1.03);
  EXPECT_LT((p_body - Eigen::Vector3d(1.0, 0.0, 0.0)).norm(), 1e-12);
  EXPECT_NEAR(rectified(cameras).baseline_m, 0.1, 1e-12);
  EXPECT_EQ(rig.imu_noise.gyroscope_noise_density, 0.00016);
  EXPECT_EQ(rig.imu_noise.accelerometer_random_walk, 0.00086);
  EXPECT_EQ(rig.imu_rate_hz, 200.0);
  EXPECT_EQ(rig.camera_time_shift, from_seconds(0.0082));
}

TEST(KalibrRig, ReadsTheImuBelowItsNameAsItsOwnCalibrationWritesIt) {
  std::string nested =
      "imu0:\n  T_i_b:\n  - [1.0, 0.0, 0.0, 0.0]\n  - [0.0, 1.0, 0.0, 0.0]\n"
      "  - [0.0, 0.0, 1.0, 0.0]\n  - [0.0, 0.0, 0.0, 1.0]\n"
      "  model: calibrated\n  time_offset: 0.0\n";
  std::istringstream lines(kImu);
  for (std::string line; std::getline(lines, line);) nested += "  " + line + "\n";
  EXPECT_EQ(read(kChain, nested).imu_noise.gyroscope_random_walk, 0.000022);
  EXPECT_THAT(error_of(kChain, replaced(nested, "0.0, 0.0, 0.0]", "0.0, 0.0, 0.2]")),
              HasSubstr("imu.yaml:2: imu0.T_i_b: must be none"));
  EXPECT_THAT(error_of(kChain, replaced(nested, "calibrated", "scale-misalignment")),
              HasSubstr("imu.yaml:7: imu0.model: only"));
  EXPECT_THAT(error_of(kChain, replaced(nested, "offset: 0.0", "offset: 0.1")),
              HasSubstr("imu.yaml:8: imu0.time_offset: must be 0"));
}

TEST(KalibrRig, TakesALensWithoutDistortion) {
  const SensorRig rig = read(replaced(kChain, "equidistant", "none"));
  EXPECT_EQ(rig.cameras.cam0.distortion, Camera::Distortion::kRadialTangential);
  EXPECT_EQ(rig.cameras.cam0.coefficients, Eigen::Vector4d::Zero());
}

TEST(KalibrRig, IsRefusedWithFileLineAndReason) {
  const auto expect = [](const std::string& chain, const std::string& message) {
    EXPECT_THAT(error_of(chain), HasSubstr("camchain.yaml:" + message));
  };
  expect(replaced(kChain, "[0.0, -1.0", "[0.1, -1.0"), "2: cam0.T_cam_imu: its rotation is not");
  expect(replaced(kChain, "[0.0, -1.0", "[0.0, 1.0"), "2: cam0.T_cam_imu: its rotation is not");
  expect(replaced(kChain, "0.02]", ".nan]"), "2: cam0.T_cam_imu: not all numbers are finite");
  expect(replaced(kChain, "0.0, 1.0]", "0.1, 1.0]"), "2: cam0.T_cam_imu: its last row");
  expect(replaced(kChain, "-1.0, 0.0, 0.01]", "-1.0, 0.0]"), "2: cam0.T_cam_imu: expected 4 rows");
  expect(replaced(kChain, "pinhole", "omni"), "8: cam0.camera_model: 'omni' is not pinhole");
  expect(replaced(kChain, "0.000715, ", ""), "9: cam0.distortion_coeffs: expected 4 numbers");
  expect(replaced(kChain, "equidistant", "fov"), "10: cam0.distortion_model: 'fov' is neither");
  expect(replaced(kChain, "190.9", "-190.9"), "11: cam0.intrinsics: the focal length");
  expect(replaced(kChain, "190.9", ".inf"), "11: cam0.intrinsics: not all numbers are finite");
  expect(replaced(kChain, "[512, 512]", "[512]"), "12: cam0.resolution: expected two positive");
  expect(replaced(kChain, "-0.1]", "-0.2]"), "21: cam1.T_cn_cnm1: contradicts");
  expect(replaced(kChain, "0.0083", "0.0101"), "32: cam1.timeshift_cam_imu: differs");
  const std::string no_baseline = replaced(replaced(kChain, "-0.09]", "0.01]"), "-0.1]", "0.0]");
  expect(no_baseline, "16: cam1.T_cam_imu: stereo calibration");
  EXPECT_THAT(error_of(replaced(kChain, "cam1:", "cam2:")), HasSubstr("cam1: missing"));
  EXPECT_THAT(error_of(kChain, replaced(kImu, "0.0028", "0")), HasSubstr("imu.yaml:3: "));
  EXPECT_THAT(error_of(kChain, replaced_last(kImu, "gyroscope_random_walk", "walk")),
              HasSubstr("gyroscope_random_walk: missing"));
  EXPECT_THROW(read_kalibr_rig({.camchain = "/nowhere", .imu = "/nowhere"}), ConfigError);
}

}  // namespace
}  // namespace fleetloc
