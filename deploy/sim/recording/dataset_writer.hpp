#pragma once

#include <filesystem>
#include <fstream>

#include "shared/dataset/dataset_error.hpp"
#include "shared/model/camera.hpp"
#include "shared/model/inertial.hpp"
#include "shared/model/stereo_frame.hpp"

namespace fleetloc {

enum class ImageFormat { kPng, kJpeg };

/// Writes a folder in the EuRoC/ASL layout that DatasetReader plays. Its poses are those of the
/// IMU. Everything throws DatasetError.
class DatasetWriter {
 public:
  struct Options {
    std::filesystem::path folder;  ///< is created
    StereoCalibration calibration;
    ImuNoise imu_noise;
    double frame_rate_hz = 0.0;
    double imu_rate_hz = 0.0;
    ImageFormat format = ImageFormat::kPng;
    int jpeg_quality = 92;
  };

  explicit DatasetWriter(const Options& options);

  // Stamps must increase, for each kind of measurement.
  void add(const ImuSample& sample);
  void add(const StereoFrame& frame);  ///< an empty image is left out
  /// A line of the ground truth: its `odom` is the frame of the ground truth.
  void add_ground_truth(Timestamp stamp, const NavState& state);

  /// Writes out what is buffered; nothing may be added afterwards.
  void finish();

 private:
  void add_image(std::ofstream& csv, const char* camera, Timestamp stamp, const cv::Mat& image);

  Options options_;
  std::ofstream cam0_csv_;
  std::ofstream cam1_csv_;
  std::ofstream imu_csv_;
  std::ofstream ground_truth_csv_;  // opened by its first line
};

}  // namespace fleetloc
