#pragma once

#include <cstddef>
#include <cstdint>

#include "deploy/sim/motion/motion_config.hpp"
#include "deploy/sim/recording/dataset_writer.hpp"
#include "deploy/sim/sensors/imu_model.hpp"
#include "deploy/sim/sensors/lidar.hpp"
#include "deploy/sim/sensors/stereo_renderer.hpp"
#include "deploy/sim/sensors/track_simulator.hpp"
#include "shared/config/config_reader.hpp"

namespace fleetloc {

/// Point cloud of all scans in map.
struct MergedCloudConfig {
  double voxel_m = 0.0;
  std::size_t max_points = 0;
  double max_range_m = 0.0;
};

/// Surfels: squares in place of map points.
struct SurfelConfig {
  double size_spacings = 0.0;  ///< half of the edge, in distances to the fourth neighbour
  double max_size_m = 0.0;     ///< of half of the edge
};

/// Somebody carries the robot over a part of its way, and no sensor takes notice.
struct CarriedConfig {
  double at_s = 0.0;
  double for_s = 0.0;  ///< of the way; 0: never
};

struct SimConfig {
  double start_s = 0.0;
  double ground_truth_hz = 0.0;
  double frame_rate_hz = 0.0;
  ImageFormat format = ImageFormat::kPng;
  int jpeg_quality = 0;
  StereoCalibration cameras;
  StereoRenderer::Config renderer;
  TrackModel tracks;
  ImuModelConfig imu;
  LidarConfig lidar;
  MergedCloudConfig merged_cloud;
  MotionMagnitudes limits;
  RecordFitConfig record;
  double speed_up_s = 0.0;
  RecordFitConfig replayed_record;
  VibrationConfig vibration;
  CarriedConfig carried;
  SurfelConfig surfels;
};

/// Throws ConfigError.
SimConfig read_sim_config(ConfigReader section);

/// The cameras of a recording: mav0/cam0 and cam1, on its IMU. Throws DatasetError.
StereoCalibration read_cameras(const std::filesystem::path& dataset);

}  // namespace fleetloc
