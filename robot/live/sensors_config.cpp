#include "robot/live/sensors_config.hpp"

#include <cctype>
#include <cmath>
#include <set>
#include <vector>

#include "shared/config/config_reader.hpp"

namespace fleetloc {
namespace {

constexpr double kMaxRate_hz = 1000.0;

bool is_ros_name(const std::string& name) {
  if (name.size() < 2 || name.front() != '/' || name.back() == '/') return false;
  char before = 'a';
  for (const char c : name) {
    const bool digit = std::isdigit(static_cast<unsigned char>(c)) != 0;
    const bool letter = std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_';
    if (!digit && !letter && c != '/') return false;
    if (before == '/' && !letter) return false;
    before = c;
  }
  return true;
}

std::string read_name(ConfigReader& section, const std::string& key) {
  auto name = section.get<std::string>(key);
  if (!is_ros_name(name)) {
    section.fail(key, "'" + name + "' is not a topic of ROS, such as /camera/left/image_raw");
  }
  return name;
}

RosTopic read_topic(ConfigReader section) {
  RosTopic topic{.name = read_name(section, "name")};
  if (!section.has("qos")) return topic;
  const auto qos = section.get<std::string>("qos");
  if (qos != "sensor_data" && qos != "default") {
    section.fail("qos", "'" + qos + "' is neither sensor_data nor default");
  }
  topic.qos = qos == "default" ? TopicQos::kDefault : TopicQos::kSensorData;
  return topic;
}

ImageTopic read_image_topic(ConfigReader section) {
  ImageTopic image{.topic = read_topic(section)};
  if (!section.has("transport")) return image;
  const auto transport = section.get<std::string>("transport");
  if (transport != "raw" && transport != "compressed") {
    section.fail("transport", "'" + transport + "' is neither raw nor compressed");
  }
  if (transport == "compressed") image.transport = ImageTransport::kCompressed;
  return image;
}

Pose read_pose(ConfigReader& section, const std::string& key) {
  constexpr double kTolerance = 1e-2;  // of the quaternion's norm: people round
  const auto numbers = section.get<std::vector<double>>(key);
  if (numbers.size() != 7) section.fail(key, "expected 7 numbers: x y z qx qy qz qw");
  for (const double number : numbers) {
    if (!std::isfinite(number)) section.fail(key, "not all numbers are finite");
  }
  const Eigen::Quaterniond R(numbers[6], numbers[3], numbers[4], numbers[5]);
  if (std::abs(R.norm() - 1.0) > kTolerance) section.fail(key, "the quaternion is not of length 1");
  return {.R = R.normalized(), .p = {numbers[0], numbers[1], numbers[2]}};
}

std::filesystem::path read_path(ConfigReader& section,
                                const std::string& key,
                                const std::filesystem::path& folder) {
  const auto text = section.get<std::string>(key);
  if (text.empty()) section.fail(key, "is empty");
  return folder / text;  // an absolute one stays
}

EurocFiles read_euroc(ConfigReader section, const std::filesystem::path& folder) {
  if (!section.has("folder")) {
    return {.cam0 = read_path(section, "cam0", folder),
            .cam1 = read_path(section, "cam1", folder),
            .imu = read_path(section, "imu", folder)};
  }
  const std::filesystem::path recording = read_path(section, "folder", folder);
  const bool is_mav0 = std::filesystem::is_directory(recording / "cam0");
  return euroc_files(is_mav0 ? recording : recording / "mav0");
}

CameraInfoSource read_camera_info(ConfigReader section) {
  CameraInfoSource source{.left = read_topic(section.section("left")),
                          .right = read_topic(section.section("right")),
                          .T_imu_cam0 = read_pose(section, "T_imu_cam0")};
  const auto images = section.get<std::string>("images");
  if (images != "raw" && images != "rectified") {
    section.fail("images", "'" + images + "' is neither raw nor rectified");
  }
  source.images = images == "raw" ? ImageKind::kRaw : ImageKind::kRectified;
  ConfigReader noise = section.section("imu_noise");
  source.imu_noise = {.gyroscope_noise_density = noise.positive("gyroscope_noise_density"),
                      .gyroscope_random_walk = noise.positive("gyroscope_random_walk"),
                      .accelerometer_noise_density = noise.positive("accelerometer_noise_density"),
                      .accelerometer_random_walk = noise.positive("accelerometer_random_walk")};
  return source;
}

CalibrationSource read_calibration(ConfigReader& root, const std::filesystem::path& folder) {
  ConfigReader section = root.section("calibration");
  const bool known = section.has("euroc") || section.has("kalibr") || section.has("camera_info");
  if (section.keys().size() != 1 || !known) {
    root.fail("calibration", "expected one of euroc, kalibr and camera_info");
  }
  if (section.has("euroc")) return read_euroc(section.section("euroc"), folder);
  if (section.has("camera_info")) return read_camera_info(section.section("camera_info"));
  ConfigReader kalibr = section.section("kalibr");
  return KalibrFiles{.camchain = read_path(kalibr, "camchain", folder),
                     .imu = read_path(kalibr, "imu", folder)};
}

void read_frame(ConfigReader& section, const std::string& key, std::string& frame) {
  if (!section.has(key)) return;
  frame = section.get<std::string>(key);
  if (frame.empty() || frame.front() == '/') {
    section.fail(key, "'" + frame + "' is not a frame id: no slash in front");
  }
}

RosFrames read_frames(ConfigReader section) {
  RosFrames frames;
  read_frame(section, "odom", frames.odom);
  read_frame(section, "map", frames.map);
  read_frame(section, "base", frames.base);
  if (std::set<std::string>{frames.odom, frames.map, frames.base}.size() < 3) {
    section.fail(section.has("base") ? "base" : "odom", "two frames have one name");
  }
  if (section.has("T_base_imu")) frames.T_base_imu = read_pose(section, "T_base_imu");
  return frames;
}

void read_rate(ConfigReader& section, const std::string& key, double& rate_hz) {
  if (section.has(key)) rate_hz = section.number(key, 0.0, kMaxRate_hz);
}

RosOutput read_output(ConfigReader section) {
  RosOutput output;
  if (section.has("odometry")) {
    ConfigReader odometry = section.section("odometry");
    if (odometry.has("topic")) output.odometry_topic = read_name(odometry, "topic");
    read_rate(odometry, "rate_hz", output.odometry_rate_hz);
  }
  if (section.has("map_pose")) {
    ConfigReader map_pose = section.section("map_pose");
    output.map_pose_topic = read_name(map_pose, "topic");
  }
  if (section.has("tf")) {
    ConfigReader tf = section.section("tf");
    read_rate(tf, "odom_base_rate_hz", output.odom_base_tf_rate_hz);
    read_rate(tf, "map_odom_rate_hz", output.map_odom_tf_rate_hz);
  }
  if (section.has("diagnostics")) output.diagnostics = section.get<bool>("diagnostics");
  return output;
}

void read_duration(ConfigReader& section,
                   const std::string& key,
                   double max_s,
                   Duration& duration) {
  constexpr double kMin_s = 1e-6;
  if (section.has(key)) duration = from_seconds(section.number(key, kMin_s, max_s));
}

SensorAssembler::Config read_tolerances(ConfigReader section) {
  SensorAssembler::Config config;
  read_duration(section, "pairing_s", 0.1, config.pairing);
  read_duration(section, "max_wait_s", 1.0, config.max_wait);
  read_duration(section, "silence_s", 60.0, config.silence);
  return config;
}

void check_topics(const ConfigReader& topics, const SensorsConfig& config) {
  std::set<std::string> names{config.left.topic.name, config.right.topic.name, config.imu.name};
  std::size_t expected = 3;
  if (const auto* infos = std::get_if<CameraInfoSource>(&config.calibration)) {
    names.insert({infos->left.name, infos->right.name});
    expected += 2;
  }
  if (names.size() < expected) topics.fail("left", "two topics have one name");
}

}  // namespace

std::string dds_name(const RosTopic& topic) {
  return "rt" + topic.name;
}

std::string dds_name(const ImageTopic& topic) {
  const bool compressed = topic.transport == ImageTransport::kCompressed;
  return dds_name(topic.topic) + (compressed ? "/compressed" : "");
}

SensorsConfig read_sensors_config(const std::filesystem::path& file) {
  return read_sensors_config(ConfigReader::from_file(file), file.parent_path());
}

SensorsConfig read_sensors_config(ConfigReader root, const std::filesystem::path& folder) {
  constexpr int kMaxDomain = 100;  // beyond, Linux may give its ports to others
  ConfigReader topics = root.section("topics");
  SensorsConfig config{.domain = root.integer("domain", 0, kMaxDomain),
                       .left = read_image_topic(topics.section("left")),
                       .right = read_image_topic(topics.section("right")),
                       .imu = read_topic(topics.section("imu")),
                       .calibration = read_calibration(root, folder)};
  if (root.has("qos")) config.qos = read_path(root, "qos", folder);
  if (root.has("frames")) config.frames = read_frames(root.section("frames"));
  if (root.has("input")) {
    ConfigReader input = root.section("input");
    config.initial_pose.name = read_name(input, "initial_pose_topic");
  }
  if (root.has("output")) config.output = read_output(root.section("output"));
  if (root.has("tolerances")) config.assembler = read_tolerances(root.section("tolerances"));
  root.expect_fully_read();
  check_topics(topics, config);
  return config;
}

std::optional<SensorRig> read_sensor_rig(const CalibrationSource& source) {
  if (const auto* euroc = std::get_if<EurocFiles>(&source)) return read_euroc_rig(*euroc);
  if (const auto* kalibr = std::get_if<KalibrFiles>(&source)) return read_kalibr_rig(*kalibr);
  return std::nullopt;
}

}  // namespace fleetloc
