#pragma once

#include <cmath>
#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "deploy/sim/recording/dataset_writer.hpp"
#include "robot/dataset/dataset_reader.hpp"
#include "shared/geometry/so3.hpp"
#include "test/test_folder.hpp"

namespace fleetloc {

inline constexpr std::int64_t kStartNs =
    1'403'636'579'758'555'392;  // more digits than a double holds

inline Timestamp at_ms(std::int64_t milliseconds) {
  return Timestamp(Duration(kStartNs) + std::chrono::milliseconds(milliseconds));
}

/// A gradient, so that JPEG changes it little; different for each frame and camera.
inline cv::Mat image_of(int number) {
  cv::Mat image(48, 64, CV_8U);
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.cols; ++column) {
      image.at<std::uint8_t>(row, column) = static_cast<std::uint8_t>(row + column + 3 * number);
    }
  }
  return image;
}

inline ImuSample imu_sample(std::int64_t milliseconds) {
  const double t = 0.001 * static_cast<double>(milliseconds);
  return {.stamp = at_ms(milliseconds),
          .angular_velocity = {std::sin(t), std::cos(t), 1.0 / 3.0},
          .specific_force = {0.1 * t, -0.2, 9.81}};
}

inline StereoCalibration calibration() {
  Camera camera{.width_px = 64,
                .height_px = 48,
                .focal_px = {40.1, 1.0 / 0.03},
                .center_px = {31.5, 23.7},
                .distortion = Camera::Distortion::kEquidistant,
                .coefficients = {0.01, -0.02, 0.003, 1e-5}};
  const Pose T_body_cam0{.R = exp_so3({0.1, -0.2, 1.5}), .p = {0.01, -0.06, 0.02}};
  StereoCalibration stereo{
      .cam0 = camera, .cam1 = camera, .T_body_cam0 = T_body_cam0, .T_body_cam1 = T_body_cam0};
  stereo.T_body_cam1.p.x() += 0.11;
  stereo.cam1.distortion = Camera::Distortion::kRadialTangential;
  return stereo;
}

inline constexpr ImuNoise kNoise{.gyroscope_noise_density = 1.7e-4,
                                 .gyroscope_random_walk = 1.9e-5,
                                 .accelerometer_noise_density = 2e-3,
                                 .accelerometer_random_walk = 3e-3};

/// Ten frames at 20 Hz from 100 ms on, IMU at 200 Hz from 0 to 700 ms.
class Dataset : public ::testing::Test {
 protected:
  Dataset() { std::filesystem::remove_all(folder_); }

  [[nodiscard]] DatasetWriter writer(ImageFormat format = ImageFormat::kPng) const {
    return DatasetWriter({.folder = folder_,
                          .calibration = calibration(),
                          .imu_noise = kNoise,
                          .frame_rate_hz = 20.0,
                          .imu_rate_hz = 200.0,
                          .format = format});
  }

  void write_all(ImageFormat format = ImageFormat::kPng) const {
    DatasetWriter dataset = writer(format);
    for (std::int64_t ms = 0; ms <= 700; ms += 5) dataset.add(imu_sample(ms));
    for (int i = 0; i < 10; ++i) dataset.add(frame(i));
    dataset.finish();
  }

  static StereoFrame frame(int number) {
    return {.stamp = at_ms(100 + 50 * number),
            .left = image_of(number),
            .right = image_of(number + 20)};
  }

  std::vector<SensorMeasurement> play(DatasetReader::Options options = {}) {
    options.folder = folder_;
    DatasetReader reader(options);
    std::vector<SensorMeasurement> items;
    while (auto item = reader.next()) items.push_back(std::move(*item));
    EXPECT_FALSE(reader.next());
    faults_ = reader.close();
    return items;
  }

  static std::vector<StereoFrame> frames_of(const std::vector<SensorMeasurement>& items) {
    std::vector<StereoFrame> frames;
    for (const auto& item : items) {
      if (const auto* frame = std::get_if<CameraFrame>(&item)) {
        frames.push_back(std::get<StereoFrame>(*frame));
      }
    }
    return frames;
  }

  std::string error_of_playing() {
    try {
      play();
    } catch (const DatasetError& error) {
      return error.what();
    }
    return "no error";
  }

  /// Changes a file of the dataset line by line; an empty result drops the line.
  void edit(const std::string& file,
            const std::function<std::string(int, const std::string&)>& edited) const {
    std::ifstream stream(folder_ / "mav0" / file);
    std::string text;
    std::string line;
    for (int number = 1; std::getline(stream, line); ++number) {
      const std::string replacement = edited(number, line);
      if (!replacement.empty()) text += replacement + "\n";
    }
    std::ofstream(folder_ / "mav0" / file) << text;
  }

  std::filesystem::path image_file(const char* camera, int number, const char* extension) const {
    const auto stamp = at_ms(100 + 50 * number).time_since_epoch().count();
    return folder_ / "mav0" / camera / "data" / (std::to_string(stamp) + extension);
  }

  const std::filesystem::path folder_ =
      test_folder() / "fleetloc_dataset" /
      ::testing::UnitTest::GetInstance()->current_test_info()->name();
  std::map<std::string, std::uint64_t> faults_;
};

}  // namespace fleetloc
