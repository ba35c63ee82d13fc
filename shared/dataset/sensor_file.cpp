#include "shared/dataset/sensor_file.hpp"

#include <cmath>
#include <fstream>
#include <iomanip>
#include <iterator>
#include <limits>
#include <sstream>
#include <vector>

#include <Eigen/LU>

#include "shared/config/config_reader.hpp"
#include "shared/dataset/dataset_error.hpp"

namespace fleetloc {
namespace {

constexpr const char* kRadialTangential = "radial-tangential";
constexpr const char* kEquidistant = "equidistant";

using Matrix4RowMajor = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;

ConfigReader open(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) throw ConfigError(file.string() + ": cannot be read");
  if (text.starts_with("%YAML")) text.front() = '#';
  return ConfigReader::from_string(text, file.string());
}

std::vector<double> numbers(ConfigReader& reader, const std::string& key, std::size_t count) {
  auto values = reader.get<std::vector<double>>(key);
  if (values.size() != count) {
    reader.fail(key,
                "expected " + std::to_string(count) + " numbers instead of " +
                    std::to_string(values.size()));
  }
  for (const double value : values) {
    if (!std::isfinite(value)) reader.fail(key, "not all numbers are finite");
  }
  return values;
}

/// T_BS of the sensor S on the rig B.
Pose read_pose_on_rig(ConfigReader& reader) {
  constexpr double kTolerance = 1e-3;  // calibrations are rounded
  auto section = reader.section("T_BS");
  const auto values = numbers(section, "data", 16);
  const Matrix4RowMajor T = Eigen::Map<const Matrix4RowMajor>(values.data());
  const Eigen::Matrix3d R = T.topLeftCorner<3, 3>();
  const bool rigid = (R.transpose() * R - Eigen::Matrix3d::Identity()).norm() < kTolerance &&
                     R.determinant() > 0.0 && T.row(3) == Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0);
  if (!rigid) reader.fail("T_BS", "not a rigid transform");
  return {.R = Eigen::Quaterniond(R).normalized(), .p = T.topRightCorner<3, 1>()};
}

double read_rate(ConfigReader& reader) {
  constexpr double kLowest_hz = 1e-3;  // so that a period is a duration
  constexpr double kHighest_hz = 1e6;
  return reader.number("rate_hz", kLowest_hz, kHighest_hz);
}

Camera::Distortion read_distortion(ConfigReader& reader) {
  const auto name = reader.get<std::string>("distortion_model");
  if (name == kRadialTangential || name == "radtan") return Camera::Distortion::kRadialTangential;
  if (name == kEquidistant) return Camera::Distortion::kEquidistant;
  reader.fail("distortion_model",
              "'" + name + "' is neither " + kRadialTangential + " nor " + kEquidistant);
}

Camera read_camera(ConfigReader& reader) {
  if (const auto model = reader.get<std::string>("camera_model"); model != "pinhole") {
    reader.fail("camera_model", "'" + model + "' is not pinhole");
  }
  const auto resolution = reader.get<std::vector<int>>("resolution");
  if (resolution.size() != 2 || resolution[0] <= 0 || resolution[1] <= 0) {
    reader.fail("resolution", "expected two positive numbers");
  }
  const auto intrinsics = numbers(reader, "intrinsics", 4);
  if (!(intrinsics[0] > 0.0 && intrinsics[1] > 0.0)) {
    reader.fail("intrinsics", "the focal length must be positive");
  }
  const auto coefficients = numbers(reader, "distortion_coefficients", 4);
  return {.width_px = resolution[0],
          .height_px = resolution[1],
          .focal_px = {intrinsics[0], intrinsics[1]},
          .center_px = {intrinsics[2], intrinsics[3]},
          .distortion = read_distortion(reader),
          .coefficients = Eigen::Vector4d(coefficients.data())};
}

/// Adds the file's name to what names only a key.
template <typename Read>
auto read(const std::filesystem::path& file, const Read& read_from) {
  try {
    auto reader = open(file);
    return read_from(reader);
  } catch (const ConfigError& error) {
    const std::string message = error.what();
    const bool named = message.starts_with(file.string());
    throw DatasetError(named ? message : file.string() + ": " + message);
  }
}

std::ostringstream exact_text() {
  std::ostringstream text;
  text << std::setprecision(std::numeric_limits<double>::max_digits10);
  return text;
}

void write_pose_on_rig(std::ostream& text, const Pose& T_rig_sensor) {
  Matrix4RowMajor T = Matrix4RowMajor::Identity();
  T.topLeftCorner<3, 3>() = T_rig_sensor.R.toRotationMatrix();
  T.topRightCorner<3, 1>() = T_rig_sensor.p;
  text << "T_BS:\n  cols: 4\n  rows: 4\n  data: [";
  for (Eigen::Index i = 0; i < T.size(); ++i) {
    text << (i == 0 ? "" : i % 4 == 0 ? ",\n         " : ", ") << T.data()[i];
  }
  text << "]\n";
}

}  // namespace

CameraFile read_camera_file(const std::filesystem::path& file) {
  return read(file, [](ConfigReader& reader) {
    return CameraFile{.camera = read_camera(reader),
                      .T_rig_cam = read_pose_on_rig(reader),
                      .rate_hz = read_rate(reader)};
  });
}

ImuFile read_imu_file(const std::filesystem::path& file) {
  return read(file, [](ConfigReader& reader) {
    const ImuNoise noise{
        .gyroscope_noise_density = reader.positive("gyroscope_noise_density"),
        .gyroscope_random_walk = reader.positive("gyroscope_random_walk"),
        .accelerometer_noise_density = reader.positive("accelerometer_noise_density"),
        .accelerometer_random_walk = reader.positive("accelerometer_random_walk")};
    return ImuFile{
        .noise = noise, .T_rig_imu = read_pose_on_rig(reader), .rate_hz = read_rate(reader)};
  });
}

LidarCalibration read_lidar_file(const std::filesystem::path& file) {
  constexpr int kMaxColumns = 65536;
  constexpr int kMaxRings = 256;
  return read(file, [](ConfigReader& reader) {
    return LidarCalibration{.T_body_lidar = read_pose_on_rig(reader),
                            .rate_hz = read_rate(reader),
                            .columns = reader.integer("columns", 1, kMaxColumns),
                            .rings = reader.integer("rings", 1, kMaxRings)};
  });
}

std::string camera_file_text(const CameraFile& file) {
  const Camera& camera = file.camera;
  const bool equidistant = camera.distortion == Camera::Distortion::kEquidistant;
  auto text = exact_text();
  text << "sensor_type: camera\n";
  write_pose_on_rig(text, file.T_rig_cam);
  text << "rate_hz: " << file.rate_hz << "\nresolution: [" << camera.width_px << ", "
       << camera.height_px << "]\ncamera_model: pinhole\nintrinsics: [" << camera.focal_px.x()
       << ", " << camera.focal_px.y() << ", " << camera.center_px.x() << ", "
       << camera.center_px.y()
       << "]\ndistortion_model: " << (equidistant ? kEquidistant : kRadialTangential)
       << "\ndistortion_coefficients: [" << camera.coefficients(0) << ", " << camera.coefficients(1)
       << ", " << camera.coefficients(2) << ", " << camera.coefficients(3) << "]\n";
  return text.str();
}

std::string imu_file_text(const ImuFile& imu) {
  auto text = exact_text();
  text << "sensor_type: imu\n";
  write_pose_on_rig(text, imu.T_rig_imu);
  text << "rate_hz: " << imu.rate_hz
       << "\ngyroscope_noise_density: " << imu.noise.gyroscope_noise_density
       << "\ngyroscope_random_walk: " << imu.noise.gyroscope_random_walk
       << "\naccelerometer_noise_density: " << imu.noise.accelerometer_noise_density
       << "\naccelerometer_random_walk: " << imu.noise.accelerometer_random_walk << '\n';
  return text.str();
}

std::string lidar_file_text(const LidarCalibration& lidar) {
  auto text = exact_text();
  text << "sensor_type: lidar\n";
  write_pose_on_rig(text, lidar.T_body_lidar);
  text << "rate_hz: " << lidar.rate_hz << "\ncolumns: " << lidar.columns
       << "\nrings: " << lidar.rings << '\n';
  return text.str();
}

}  // namespace fleetloc
