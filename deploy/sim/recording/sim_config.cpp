#include "deploy/sim/recording/sim_config.hpp"

#include <cmath>
#include <string>
#include <vector>

#include "shared/config/option_check.hpp"
#include "shared/dataset/sensor_file.hpp"
#include "shared/geometry/angle.hpp"

namespace fleetloc {
namespace {

std::vector<double> numbers(ConfigReader& reader, const std::string& key, std::size_t count) {
  auto values = reader.get<std::vector<double>>(key);
  if (values.size() != count) {
    throw ConfigError(key + ": expected " + std::to_string(count) + " numbers");
  }
  for (const double value : values) {
    if (!std::isfinite(value)) throw ConfigError(key + ": not finite");
  }
  return values;
}

StereoCalibration read_cameras(ConfigReader reader) {
  constexpr int kLargest = 4096;  // [px]
  const auto resolution = numbers(reader, "resolution_px", 2);
  for (const double side : resolution) {
    if (side < 64 || side > kLargest) throw ConfigError("resolution_px: must be in 64..4096");
  }
  StereoCalibration stereo;
  stereo.cam0 = {.width_px = static_cast<int>(resolution[0]),
                 .height_px = static_cast<int>(resolution[1]),
                 .focal_px = Eigen::Vector2d::Constant(reader.positive("focal_px")),
                 .center_px = {0.5 * (resolution[0] - 1.0), 0.5 * (resolution[1] - 1.0)},
                 .distortion = Camera::Distortion::kRadialTangential,
                 .coefficients = Eigen::Vector4d(numbers(reader, "distortion", 4).data())};
  stereo.cam1 = stereo.cam0;
  // Columns: the camera's x (right), y (down) and z (forward) in the body.
  Eigen::Matrix3d level;
  level << 0.0, 0.0, 1.0,  //
      -1.0, 0.0, 0.0,      //
      0.0, -1.0, 0.0;
  const double down = kRadPerDeg * reader.get<double>("down_deg");
  const Eigen::Quaterniond R =
      Eigen::AngleAxisd(down, Eigen::Vector3d::UnitY()) * Eigen::Quaterniond(level);
  const Eigen::Vector3d p(numbers(reader, "position_m", 3).data());
  const Eigen::Vector3d across(0.0, -reader.positive("baseline_m"), 0.0);
  stereo.T_body_cam0 = {.R = R, .p = p};
  stereo.T_body_cam1 = {.R = R, .p = p + across};
  return stereo;
}

RecordFitConfig read_replayed_record(ConfigReader section) {
  constexpr double kNone = 1e12;
  RecordFitConfig config;
  config.knot_interval_s = section.positive("knot_interval_s");
  config.position_cutoff_hz = config.rotation_cutoff_hz = section.positive("cutoff_hz");
  config.max_gap_s = section.positive("max_gap_s");
  config.limits = {kNone, kNone, kNone, kNone};
  return config;
}

}  // namespace

SimConfig read_sim_config(ConfigReader section) {
  constexpr int kMaxPoints = 50'000'000;
  SimConfig config;
  config.start_s = section.positive("start_s");
  config.ground_truth_hz = section.positive("ground_truth_hz");
  ConfigReader images = section.section("images");
  config.frame_rate_hz = images.positive("rate_hz");
  config.jpeg_quality = images.integer("jpeg_quality", 0, 100);
  config.format = config.jpeg_quality > 0 ? ImageFormat::kJpeg : ImageFormat::kPng;
  config.cameras = read_cameras(section.section("cameras"));
  config.renderer = read_stereo_renderer_config(section.section("renderer"));
  config.tracks = read_track_model(section.section("tracks"));
  config.imu = read_imu_model_config(section.section("imu"));
  config.lidar = read_lidar_config(section.section("lidar"));
  ConfigReader merged = section.section("merged_cloud");
  config.merged_cloud = {
      .voxel_m = merged.positive("voxel_m"),
      .max_points = static_cast<std::size_t>(merged.integer("max_points", 8, kMaxPoints)),
      .max_range_m = merged.positive("max_range_m")};
  config.limits = read_motion_limits(section.section("limits"));
  ConfigReader record = section.section("record");
  config.record = read_record_fit_config(record, config.limits);
  config.speed_up_s = record.positive("speed_up_s");
  config.replayed_record = read_replayed_record(section.section("replayed_record"));
  config.vibration = read_vibration_config(section.section("vibration"));
  ConfigReader carried = section.section("carried");
  config.carried = {.at_s = carried.number("at_s", 0.0, kLongest_s),
                    .for_s = carried.number("for_s", 0.0, kLongest_s)};
  ConfigReader surfels = section.section("surfels");
  config.surfels = {.size_spacings = surfels.positive("size_spacings"),
                    .max_size_m = surfels.positive("max_size_m")};
  section.expect_fully_read();
  return config;
}

StereoCalibration read_cameras(const std::filesystem::path& dataset) {
  const auto mav0 = std::filesystem::is_directory(dataset / "mav0") ? dataset / "mav0" : dataset;
  const CameraFile left = read_camera_file(mav0 / "cam0" / "sensor.yaml");
  const CameraFile right = read_camera_file(mav0 / "cam1" / "sensor.yaml");
  const Pose T_imu_rig = inverse(read_imu_file(mav0 / "imu0" / "sensor.yaml").T_rig_imu);
  return {.cam0 = left.camera,
          .cam1 = right.camera,
          .T_body_cam0 = T_imu_rig * left.T_rig_cam,
          .T_body_cam1 = T_imu_rig * right.T_rig_cam};
}

}  // namespace fleetloc
