#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>

#include "robot/calibration/camera_info.hpp"
#include "robot/calibration/euroc_rig.hpp"
#include "robot/calibration/kalibr_rig.hpp"
#include "robot/live/sensor_assembler.hpp"

namespace fleetloc {

class ConfigReader;

/// The QoS profile of ROS 2 that a topic is read with.
enum class TopicQos {
  kSensorData,  ///< best effort: a publisher of either kind matches
  kDefault,     ///< reliable: the publisher must be, too
};

enum class ImageTransport { kRaw, kCompressed };

struct RosTopic {
  std::string name;  ///< as ROS writes it, e.g. "/imu"
  TopicQos qos = TopicQos::kSensorData;
};

struct ImageTopic {
  RosTopic topic;  ///< that of the raw images, also where compressed ones are read
  ImageTransport transport = ImageTransport::kRaw;
};

/// Its name in DDS: "rt/imu".
std::string dds_name(const RosTopic& topic);
/// "rt/camera/left/image_raw", or "rt/camera/left/image_raw/compressed".
std::string dds_name(const ImageTopic& topic);

/// The cameras' calibration comes on topics.
struct CameraInfoSource {
  RosTopic left;
  RosTopic right;
  ImageKind images = ImageKind::kRectified;
  Pose T_imu_cam0 = {};  ///< of the left camera, as stereo_calibration() has it
  ImuNoise imu_noise = {};
};

using CalibrationSource = std::variant<EurocFiles, KalibrFiles, CameraInfoSource>;

/// Frame ids of what is published (REP 105).
struct RosFrames {
  std::string odom = "odom";
  std::string map = "map";
  std::string base = "base_link";
  Pose T_base_imu;
};

/// What is published. A rate of 0 publishes nothing.
struct RosOutput {
  std::string odometry_topic = "/odometry";
  double odometry_rate_hz = 50.0;
  std::string map_pose_topic = "/map_pose";
  double odom_base_tf_rate_hz = 50.0;
  double map_odom_tf_rate_hz = 10.0;
  bool diagnostics = true;
};

/// A robot's live sensors, as `sensors.yaml` describes them.
struct SensorsConfig {
  int domain = 0;
  std::optional<std::filesystem::path> qos = std::nullopt;  ///< in place of the built-in ros2.xml
  ImageTopic left;
  ImageTopic right;
  RosTopic imu;
  CalibrationSource calibration;
  RosFrames frames = {};
  /// PoseWithCovarianceStamped in map, as RViz publishes its "2D Pose Estimate".
  RosTopic initial_pose{.name = "/initialpose", .qos = TopicQos::kDefault};
  RosOutput output = {};
  SensorAssembler::Config assembler = {};  ///< without the time shift, which the calibration tells
};

/// Topics, calibration and a key's unknown name, wrong type or range: ConfigError with file, line
/// and reason. Files of the calibration are not opened yet; relative ones are beside `file`.
SensorsConfig read_sensors_config(const std::filesystem::path& file);

/// The same of what has been read already.
/// @param folder  that relative paths are in
SensorsConfig read_sensors_config(ConfigReader root, const std::filesystem::path& folder);

/// The calibration from its files; nothing if it comes on topics. Throws ConfigError and
/// DatasetError.
std::optional<SensorRig> read_sensor_rig(const CalibrationSource& source);

}  // namespace fleetloc
