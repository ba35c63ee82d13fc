// fleetloc-play and fleetloc-robot as separate processes: a recording as topics of ROS 2, on one
// computer or on two.
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <optional>
#include <ostream>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robot/dataset/dataset_reader.hpp"
#include "test/system/live_fixture.hpp"
#include "test/system/network_namespace.hpp"

namespace fleetloc {
namespace {

using ::testing::Ge;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kRobot = "robot_1";

/// A flight, and how much of it is played in real time.
struct LiveCase {
  const char* name;
  RecordedFlight (*flight)();
  const char* duration_s;
};
void PrintTo(const LiveCase& one, std::ostream* stream) {
  *stream << one.name;
}

class LiveFlight : public LiveFixture, public testing::WithParamInterface<LiveCase> {
 protected:
  void SetUp() override {
    if (kSanitized) GTEST_SKIP() << "sanitizers are too slow for real time";
    flight_ = GetParam().flight();
    if (const auto reason = why_missing(flight_)) GTEST_SKIP() << *reason;
    describe_sensors();
  }

  /// What a player runs until it has played.
  [[nodiscard]] Outcome played(const std::filesystem::path& sensors) const {
    return run(FLEETLOC_PLAY,
               {flight_.folder.string(),
                "--sensors",
                sensors.string(),
                "--duration",
                GetParam().duration_s,
                "--wait",
                "60"});
  }

  /// That the robot has used at least 99 % of what was played.
  void expect_used(ChildProgram& robot, const Outcome& played) const {
    robot.signal(SIGTERM);
    const Outcome flown = robot.wait();
    EXPECT_EQ(played.exit_code, 0) << played.errors;
    EXPECT_THAT(played.output, Not(HasSubstr("nobody reads")));
    EXPECT_EQ(flown.exit_code, 0) << flown.errors;
    const auto summary = parsed_json(folder_of(kRobot) / "summary.json");
    std::cout << summary.dump() << '\n';
    const auto& faults = summary.at("input_faults");
    const DatasetReader recording(
        {.folder = flight_.folder, .duration_s = std::stod(GetParam().duration_s)});
    const double pairs = summary.at("frames").get<double>() - faults.value("unpaired_images", 0.0);
    EXPECT_THAT(pairs, Ge(0.99 * static_cast<double>(*recording.frame_count())));
    EXPECT_THAT(share_of_frames(folder_of(kRobot), "odometry.tum"), Ge(0.8));
  }
};

TEST_P(LiveFlight, UsesNearlyAllPairsThatArePlayed) {
  ChildProgram robot(FLEETLOC_ROBOT, live_robot(kRobot));
  expect_used(robot, played(sensors_));
}

/// Drivers that tell the calibration beside the images, which are JPEG.
class LiveCalibration : public LiveFlight {
 protected:
  void SetUp() override {
    LiveFlight::SetUp();
    if (IsSkipped()) return;
    const DatasetReader recording({.folder = flight_.folder});
    const Pose& T_imu_cam0 = recording.calibration().T_body_cam0;
    const ImuNoise& noise = recording.imu_noise();
    std::ofstream file(sensors_);
    file.precision(17);
    file << "domain: " << ros_domain()
         << "\ntopics:"
            "\n  left: {name: /camera/left/image_raw, transport: compressed, qos: default}"
            "\n  right: {name: /camera/right/image_raw, transport: compressed, qos: default}"
            "\n  imu: {name: /imu, qos: default}"
            "\ncalibration:\n  camera_info:"
            "\n    left: {name: /camera/left/camera_info, qos: default}"
            "\n    right: {name: /camera/right/camera_info, qos: default}"
            "\n    images: raw"
         << "\n    T_imu_cam0: [" << T_imu_cam0.p.x() << ", " << T_imu_cam0.p.y() << ", "
         << T_imu_cam0.p.z() << ", " << T_imu_cam0.R.x() << ", " << T_imu_cam0.R.y() << ", "
         << T_imu_cam0.R.z() << ", " << T_imu_cam0.R.w() << "]"
         << "\n    imu_noise:"
         << "\n      gyroscope_noise_density: " << noise.gyroscope_noise_density
         << "\n      gyroscope_random_walk: " << noise.gyroscope_random_walk
         << "\n      accelerometer_noise_density: " << noise.accelerometer_noise_density
         << "\n      accelerometer_random_walk: " << noise.accelerometer_random_walk << "\n";
  }
};

TEST_P(LiveCalibration, ComesOnTopicsBesideCompressedImages) {
  ChildProgram robot(FLEETLOC_ROBOT, live_robot(kRobot));
  expect_used(robot, played(sensors_));
}

/// A camera with a computer of its own, on a network without multicast.
class CameraNetwork : public LiveFlight {
 protected:
  void SetUp() override {
    if (const auto reason = NetworkNamespace::why_impossible()) GTEST_SKIP() << *reason;
    LiveFlight::SetUp();
    switch_.emplace(false);
    switch_->plug_in(robot_.emplace(), kRobotAddress);
    switch_->plug_in(camera_.emplace(), kCameraAddress);
  }

  /// sensors.yaml of the computer with that address, which looks for the other one.
  [[nodiscard]] std::filesystem::path sensors_at(const std::string& address,
                                                 const std::string& other) const {
    const auto folder = scratch_ / address;
    std::filesystem::create_directory(folder);
    const std::filesystem::path profiles = FLEETLOC_SOURCE_DIR "/qos_profiles";
    std::filesystem::copy_file(profiles / "ros2.xml", folder / "ros2.xml");
    std::ifstream shipped(profiles / "ros2-network.xml");
    std::string network{std::istreambuf_iterator<char>(shipped), {}};
    for (const auto& [example, actual] :
         {std::pair("192.168.2.1", address), std::pair("192.168.2.2", other)}) {
      network.replace(network.find(example), std::strlen(example), actual);
    }
    std::ofstream(folder / "ros2-network.xml") << network;
    describe_sensors("default", "qos: " + (folder / "ros2-network.xml").string() + "\n");
    std::filesystem::rename(sensors_, folder / "sensors.yaml");
    return folder / "sensors.yaml";
  }

  static constexpr const char* kRobotAddress = "10.78.0.1";
  static constexpr const char* kCameraAddress = "10.78.0.2";
  std::optional<SwitchedNetwork> switch_;
  std::optional<NetworkNamespace> robot_;
  std::optional<NetworkNamespace> camera_;
};

TEST_P(CameraNetwork, BringsNearlyAllPairsToTheRobot) {
  const auto at_camera = sensors_at(kCameraAddress, kRobotAddress);
  std::filesystem::rename(sensors_at(kRobotAddress, kCameraAddress), sensors_);
  std::optional<ChildProgram> robot;
  {
    const auto inside = robot_->enter();
    robot.emplace(FLEETLOC_ROBOT, live_robot(kRobot));
  }
  const auto inside = camera_->enter();
  expect_used(*robot, played(at_camera));
}

INSTANTIATE_TEST_SUITE_P(Simulated,
                         LiveFlight,
                         testing::Values(LiveCase{"Room", simulated_room, "25"}),
                         [](const auto& one) { return std::string(one.param.name); });
INSTANTIATE_TEST_SUITE_P(Simulated,
                         LiveCalibration,
                         testing::Values(LiveCase{"Room", simulated_room, "6"}),
                         [](const auto& one) { return std::string(one.param.name); });
INSTANTIATE_TEST_SUITE_P(Simulated,
                         CameraNetwork,
                         testing::Values(LiveCase{"Room", simulated_room, "10"}),
                         [](const auto& one) { return std::string(one.param.name); });
INSTANTIATE_TEST_SUITE_P(Recorded,
                         LiveFlight,
                         testing::Values(LiveCase{"Flight", vicon_room, "25"}),
                         [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace fleetloc
