#include "shared/dataset/sensor_file.hpp"

#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "shared/dataset/dataset_error.hpp"
#include "test/test_folder.hpp"

namespace fleetloc {
namespace {

using ::testing::HasSubstr;

const std::string kCamera = R"(# General sensor definitions.
sensor_type: camera
comment: VI-Sensor cam0 (MT9M034)
T_BS:
  cols: 4
  rows: 4
  data: [0.0, -1.0, 0.0, -0.02,
         1.0, 0.0, 0.0, -0.06,
         0.0, 0.0, 1.0, 0.01,
         0.0, 0.0, 0.0, 1.0]
rate_hz: 20
resolution: [752, 480]
camera_model: pinhole
intrinsics: [458.5, 457.25, 367.0, 248.0] #fu, fv, cu, cv
distortion_model: radial-tangential
distortion_coefficients: [-0.28, 0.07, 0.0002, 1.76e-05]
)";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

CameraFile read(const std::string& text) {
  const std::string file = (test_folder() / "fleetloc_sensor.yaml").string();
  std::ofstream(file) << text;
  return read_camera_file(file);
}

std::string error_of(const std::string& text) {
  try {
    read(text);
  } catch (const DatasetError& error) {
    return error.what();
  }
  return "no error";
}

TEST(SensorFile, ReadsEurocsFilesWithAndWithoutTheLineOfOpenCv) {
  for (const std::string& text : {kCamera, "%YAML:1.0\n" + kCamera}) {
    const CameraFile file = read(text);
    EXPECT_EQ(file.camera.width_px, 752);
    EXPECT_EQ(file.camera.height_px, 480);
    EXPECT_EQ(file.camera.focal_px, Eigen::Vector2d(458.5, 457.25));
    EXPECT_EQ(file.camera.center_px, Eigen::Vector2d(367.0, 248.0));
    EXPECT_EQ(file.camera.distortion, Camera::Distortion::kRadialTangential);
    EXPECT_EQ(file.camera.coefficients, Eigen::Vector4d(-0.28, 0.07, 0.0002, 1.76e-05));
    EXPECT_EQ(file.rate_hz, 20.0);
    EXPECT_EQ(file.T_rig_cam.p, Eigen::Vector3d(-0.02, -0.06, 0.01));
    const Eigen::Vector3d x_in_rig = file.T_rig_cam.R * Eigen::Vector3d::UnitX();
    EXPECT_TRUE(x_in_rig.isApprox(Eigen::Vector3d::UnitY()));
  }
}

TEST(SensorFile, ReadsTheEquidistantModel) {
  const auto text = replaced(kCamera, "radial-tangential", "equidistant");
  EXPECT_EQ(read(text).camera.distortion, Camera::Distortion::kEquidistant);
}

TEST(SensorFile, NamesWhatIsWrong) {
  EXPECT_THAT(error_of(replaced(kCamera, "radial-tangential", "fov")),
              HasSubstr("fleetloc_sensor.yaml:15: distortion_model: 'fov'"));
  EXPECT_THAT(error_of(replaced(kCamera, "0.0002, ", "")),
              HasSubstr(":16: distortion_coefficients: expected 4 numbers instead of 3"));
  EXPECT_THAT(error_of(replaced(kCamera, "-1.0", "1.0")), HasSubstr(":4: T_BS: not a rigid"));
  EXPECT_THAT(error_of(replaced(kCamera, "-0.06", ".nan")), HasSubstr(":7: T_BS.data: not all"));
  EXPECT_THAT(error_of(replaced(kCamera, "458.5", ".nan")), HasSubstr(":14: intrinsics: not all"));
  EXPECT_THAT(error_of(replaced(kCamera, "457.25", "-1")), HasSubstr(":14: intrinsics: the focal"));
  for (const char* rate : {"rate_hz: 0", "rate_hz: 1e-300", "rate_hz: 1e300", "rate_hz: .nan"}) {
    EXPECT_THAT(error_of(replaced(kCamera, "rate_hz: 20", rate)), HasSubstr(":11: rate_hz"));
  }
  EXPECT_THAT(error_of(replaced(kCamera, "pinhole", "omni")),
              HasSubstr(":13: camera_model: 'omni'"));
  EXPECT_THAT(error_of(replaced(kCamera, "resolution", "size")), HasSubstr("resolution: missing"));
  EXPECT_THROW(read_camera_file("/nowhere/sensor.yaml"), DatasetError);
}

}  // namespace
}  // namespace fleetloc
