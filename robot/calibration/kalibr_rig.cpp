#include "robot/calibration/kalibr_rig.hpp"

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/LU>

#include "robot/calibration/rotation_check.hpp"
#include "shared/config/config_reader.hpp"

namespace fleetloc {
namespace {

constexpr double kPoseTolerance = 1e-3;  // [rad] and [m], of one pose stated twice

struct KalibrCamera {
  Camera camera;
  Pose T_cam_imu;
  double time_shift_s = 0.0;
};

std::vector<double> finite_numbers(ConfigReader& section,
                                   const std::string& key,
                                   std::size_t count) {
  auto values = section.get<std::vector<double>>(key);
  if (values.size() != count) {
    section.fail(key,
                 "expected " + std::to_string(count) + " numbers instead of " +
                     std::to_string(values.size()));
  }
  for (const double value : values) {
    if (!std::isfinite(value)) section.fail(key, "not all numbers are finite");
  }
  return values;
}

/// A matrix of 4x4, row by row.
Pose read_pose(ConfigReader& section, const std::string& key) {
  const auto rows = section.get<std::vector<std::vector<double>>>(key);
  if (rows.size() != 4) section.fail(key, "expected 4 rows of 4 numbers");
  Eigen::Matrix4d T;
  for (std::size_t i = 0; i < 4; ++i) {
    if (rows[i].size() != 4) section.fail(key, "expected 4 rows of 4 numbers");
    T.row(static_cast<Eigen::Index>(i)) = Eigen::RowVector4d(rows[i].data());
  }
  if (!T.allFinite()) section.fail(key, "not all numbers are finite");
  const Eigen::Matrix3d R = T.topLeftCorner<3, 3>();
  if (!is_rotation(R)) section.fail(key, "its rotation is not orthonormal");
  if (T.row(3) != Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0)) {
    section.fail(key, "its last row is not 0 0 0 1");
  }
  return {.R = Eigen::Quaterniond(R).normalized(), .p = T.topRightCorner<3, 1>()};
}

void read_distortion(ConfigReader& section, Camera& camera) {
  const auto name = section.get<std::string>("distortion_model");
  if (name == "none") return;
  if (name != "radtan" && name != "equidistant") {
    section.fail("distortion_model", "'" + name + "' is neither radtan nor equidistant nor none");
  }
  if (name == "equidistant") camera.distortion = Camera::Distortion::kEquidistant;
  camera.coefficients = Eigen::Vector4d(finite_numbers(section, "distortion_coeffs", 4).data());
}

Camera read_camera(ConfigReader& section) {
  if (const auto model = section.get<std::string>("camera_model"); model != "pinhole") {
    section.fail("camera_model", "'" + model + "' is not pinhole");
  }
  const auto resolution = section.get<std::vector<int>>("resolution");
  if (resolution.size() != 2 || resolution[0] <= 0 || resolution[1] <= 0) {
    section.fail("resolution", "expected two positive numbers");
  }
  const auto intrinsics = finite_numbers(section, "intrinsics", 4);
  if (!(intrinsics[0] > 0.0 && intrinsics[1] > 0.0)) {
    section.fail("intrinsics", "the focal length must be positive");
  }
  Camera camera{.width_px = resolution[0],
                .height_px = resolution[1],
                .focal_px = {intrinsics[0], intrinsics[1]},
                .center_px = {intrinsics[2], intrinsics[3]}};
  read_distortion(section, camera);
  return camera;
}

KalibrCamera read_kalibr_camera(ConfigReader& section) {
  constexpr double kMaxShift_s = 1.0;
  KalibrCamera camera{.camera = read_camera(section), .T_cam_imu = read_pose(section, "T_cam_imu")};
  if (section.has("timeshift_cam_imu")) {
    camera.time_shift_s = section.number("timeshift_cam_imu", -kMaxShift_s, kMaxShift_s);
  }
  return camera;
}

void check_consistency(ConfigReader& cam1, const KalibrCamera& left, const KalibrCamera& right) {
  if (cam1.has("T_cn_cnm1")) {
    const Pose T_cam1_cam0 = read_pose(cam1, "T_cn_cnm1");
    const Vector6d error =
        local_coordinates(right.T_cam_imu * inverse(left.T_cam_imu), T_cam1_cam0);
    if (error.cwiseAbs().maxCoeff() > kPoseTolerance) {
      cam1.fail("T_cn_cnm1", "contradicts T_cam_imu of both cameras");
    }
  }
  if (std::abs(left.time_shift_s - right.time_shift_s) > kMaxTimeShiftDifference_s) {
    cam1.fail("timeshift_cam_imu", "differs from cam0's by more than 1 ms: one clock is needed");
  }
}

ImuNoise read_noise(ConfigReader& imu) {
  return {.gyroscope_noise_density = imu.positive("gyroscope_noise_density"),
          .gyroscope_random_walk = imu.positive("gyroscope_random_walk"),
          .accelerometer_noise_density = imu.positive("accelerometer_noise_density"),
          .accelerometer_random_walk = imu.positive("accelerometer_random_walk")};
}

void read_imu(const std::filesystem::path& file, SensorRig& rig) {
  ConfigReader root = ConfigReader::from_file(file);
  ConfigReader imu = root.has("imu0") ? root.section("imu0") : root;
  if (imu.has("model") && imu.get<std::string>("model") != "calibrated") {
    imu.fail("model", "only 'calibrated' is known: other models correct the measurements");
  }
  if (imu.has("T_i_b") && log_se3(read_pose(imu, "T_i_b")).norm() > kPoseTolerance) {
    imu.fail("T_i_b", "must be none: T_cam_imu refers to this IMU");
  }
  if (imu.has("time_offset") && imu.get<double>("time_offset") != 0.0) {
    imu.fail("time_offset", "must be 0: timeshift_cam_imu refers to this IMU");
  }
  rig.imu_noise = read_noise(imu);
  rig.imu_rate_hz = imu.positive("update_rate");
}

}  // namespace

SensorRig read_kalibr_rig(const KalibrFiles& files) {
  ConfigReader chain = ConfigReader::from_file(files.camchain);
  ConfigReader cam0 = chain.section("cam0");
  ConfigReader cam1 = chain.section("cam1");
  const KalibrCamera left = read_kalibr_camera(cam0);
  const KalibrCamera right = read_kalibr_camera(cam1);
  check_consistency(cam1, left, right);
  SensorRig rig{.cameras = {.cam0 = left.camera,
                            .cam1 = right.camera,
                            .T_body_cam0 = inverse(left.T_cam_imu),
                            .T_body_cam1 = inverse(right.T_cam_imu)},
                .camera_time_shift = from_seconds(0.5 * (left.time_shift_s + right.time_shift_s))};
  try {
    rectified(rig.cameras);
  } catch (const std::invalid_argument& error) {
    cam1.fail("T_cam_imu", error.what());
  }
  read_imu(files.imu, rig);
  return rig;
}

}  // namespace fleetloc
