#include "robot/live/sensors_config.hpp"

#include <fstream>

#include <gmock/gmock.h>

#include "test/test_folder.hpp"
#include "test/unit/config/config_error.hpp"

namespace fleetloc {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

const std::string kMinimal = R"(domain: 3
topics:
  left: {name: /left/image_raw}
  right: {name: /right/image_raw, transport: compressed, qos: default}
  imu: {name: /imu/data}
calibration:
  kalibr: {camchain: chain.yaml, imu: /etc/imu.yaml}
)";

const std::string kInfo = R"(domain: 0
topics:
  left: {name: /l}
  right: {name: /r}
  imu: {name: /imu}
calibration:
  camera_info:
    left: {name: /l/camera_info}
    right: {name: /r/camera_info, qos: default}
    images: raw
    T_imu_cam0: [1, 2, 3, 0, 0, 1, 0]
    imu_noise:
      gyroscope_noise_density: 1e-3
      gyroscope_random_walk: 1e-5
      accelerometer_noise_density: 1e-2
      accelerometer_random_walk: 1e-4
input: {initial_pose_topic: /r1/initialpose}
frames: {odom: r1/odom, T_base_imu: [0.1, 0, 0, 0, 0, 0, 1]}
output:
  odometry: {rate_hz: 200}
  tf: {map_odom_rate_hz: 0}
  diagnostics: false
tolerances: {pairing_s: 0.002, silence_s: 1}
)";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

SensorsConfig read(const std::string& text) {
  const auto file = test_folder() / "sensors.yaml";
  std::ofstream(file) << text;
  return read_sensors_config(file);
}

std::string error_of(const std::string& text) {
  return config_error([&] { read(text); });
}

TEST(SensorsConfig, NeedsTopicsAndACalibrationOnly) {
  const SensorsConfig config = read(kMinimal);
  EXPECT_EQ(config.domain, 3);
  EXPECT_EQ(dds_name(config.left), "rt/left/image_raw");
  EXPECT_EQ(dds_name(config.right), "rt/right/image_raw/compressed");
  EXPECT_EQ(dds_name(config.imu), "rt/imu/data");
  EXPECT_EQ(config.left.topic.qos, TopicQos::kSensorData);
  EXPECT_EQ(config.right.topic.qos, TopicQos::kDefault);
  const auto& files = std::get<KalibrFiles>(config.calibration);
  EXPECT_EQ(files.camchain, test_folder() / "chain.yaml");
  EXPECT_EQ(files.imu, "/etc/imu.yaml");
  EXPECT_EQ(config.frames.base, "base_link");
  EXPECT_EQ(dds_name(config.initial_pose), "rt/initialpose");
  EXPECT_EQ(config.assembler.silence, Duration(500ms));
  EXPECT_FALSE(config.qos);
}

TEST(SensorsConfig, ReadsEverythingElse) {
  const SensorsConfig config = read(kInfo);
  const auto& infos = std::get<CameraInfoSource>(config.calibration);
  EXPECT_EQ(infos.images, ImageKind::kRaw);
  EXPECT_EQ(infos.right.qos, TopicQos::kDefault);
  EXPECT_EQ(infos.T_imu_cam0.p, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(infos.T_imu_cam0.R.z(), 1.0);
  EXPECT_EQ(infos.imu_noise.accelerometer_noise_density, 1e-2);
  EXPECT_EQ(config.frames.odom, "r1/odom");
  EXPECT_EQ(dds_name(config.initial_pose), "rt/r1/initialpose");
  EXPECT_EQ(config.frames.T_base_imu.p.x(), 0.1);
  EXPECT_EQ(config.output.odometry_rate_hz, 200.0);
  EXPECT_EQ(config.output.map_odom_tf_rate_hz, 0.0);
  EXPECT_FALSE(config.output.diagnostics);
  EXPECT_EQ(config.assembler.pairing, Duration(2ms));
  EXPECT_FALSE(read_sensor_rig(config.calibration).has_value());
}

TEST(SensorsConfig, NamesProfilesBesideItself) {
  EXPECT_EQ(read(kMinimal + "qos: my_ros2.xml\n").qos, test_folder() / "my_ros2.xml");
}

TEST(SensorsConfig, IsRefusedWithFileLineAndReason) {
  const auto expect = [](const std::string& text, const std::string& message) {
    EXPECT_THAT(error_of(text), HasSubstr("sensors.yaml:" + message));
  };
  expect(replaced(kMinimal, "domain: 3", "domain: 300"), "1: domain: must be in 0..100");
  expect(replaced(kMinimal, "domain", "domian"), "1: domain: missing");
  expect(kMinimal + "tolerance: {}\n", "8: tolerance: unknown key");
  expect(replaced(kMinimal, "/left/image_raw", "left"), "3: topics.left.name: 'left' is not");
  expect(replaced(kMinimal, "/left/image_raw", "/left/"), "3: topics.left.name: '/left/' is not");
  expect(replaced(kMinimal, "/left/image_raw", "/left/1"), "3: topics.left.name: ");
  expect(replaced(kMinimal, "/left/image_raw", "/left image"), "3: topics.left.name: ");
  expect(replaced(kMinimal, "/left/image_raw", "/imu/data"), "3: topics.left: two topics");
  expect(replaced(kMinimal, "compressed", "theora"), "4: topics.right.transport: 'theora'");
  expect(replaced(kMinimal, "default", "best"), "4: topics.right.qos: 'best' is neither");
  expect(replaced(kMinimal, "{name: /imu/data}", "/imu"), "5: topics.imu: expected a section");
  expect(replaced(kMinimal, "{name: /imu/data}", "{}"), "5: topics.imu.name: missing");
  expect(replaced(kMinimal, "kalibr:", "ros:"), "6: calibration: expected one of");
  expect(replaced(kMinimal, "camchain: chain.yaml, ", ""),
         "7: calibration.kalibr.camchain: missing");
  expect(kMinimal + "  euroc: {folder: x}\n", "6: calibration: expected one of");
  expect(replaced(kInfo, "images: raw", "images: rect"), "10: calibration.camera_info.images: ");
  expect(replaced(kInfo, "0, 0, 1, 0]", "0, 0, 1]"),
         "11: calibration.camera_info.T_imu_cam0: expe");
  expect(replaced(kInfo, "0, 0, 1, 0]", "0, 0, 1, 1]"),
         "11: calibration.camera_info.T_imu_cam0: th");
  expect(replaced(kInfo, "[1, 2", "[.nan, 2"), "11: calibration.camera_info.T_imu_cam0: not all");
  expect(replaced(kInfo, "1e-5", "0"), "14: calibration.camera_info.imu_noise.gyroscope_random");
  expect(replaced(kInfo, "r1/odom", "map"), "18: frames.odom: two frames have one name");
  expect(replaced(kInfo, "r1/odom", "/odom"), "18: frames.odom: '/odom' is not a frame id");
  expect(replaced(kInfo, "/r1/initialpose", "initialpose"), "17: input.initial_pose_topic: ");
  expect(replaced(kInfo, "200", "-1"), "20: output.odometry.rate_hz: must be in 0..1000");
  expect(replaced(kInfo, "false", "perhaps"), "22: output.diagnostics: ");
  expect(replaced(kInfo, "0.002", "0"), "23: tolerances.pairing_s: must be in");
}

TEST(SensorsConfig, OfTheExamplesIsValid) {
  const std::filesystem::path folder = FLEETLOC_SOURCE_DIR "/deploy/config";
  const SensorsConfig play = read_sensors_config(folder / "sensors-play.yaml");
  EXPECT_EQ(dds_name(play.left), "rt/camera/left/image_raw");
  EXPECT_EQ(std::get<EurocFiles>(play.calibration).cam0,
            folder / "DATASET" / "mav0" / "cam0" / "sensor.yaml");
  const SensorsConfig realsense = read_sensors_config(folder / "sensors-realsense.yaml");
  EXPECT_EQ(std::get<CameraInfoSource>(realsense.calibration).images, ImageKind::kRectified);
  EXPECT_EQ(realsense.output.odometry_topic, RosOutput{}.odometry_topic);
  EXPECT_EQ(realsense.assembler.pairing, SensorAssembler::Config{}.pairing);
  EXPECT_EQ(realsense.assembler.max_wait, SensorAssembler::Config{}.max_wait);
}

}  // namespace
}  // namespace fleetloc
