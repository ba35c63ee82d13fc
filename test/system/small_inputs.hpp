#pragma once

#include <filesystem>
#include <fstream>

#include <opencv2/core.hpp>

#include "deploy/sim/recording/dataset_writer.hpp"
#include "test/unit/model/euroc_calibration.hpp"

namespace fleetloc {

/// Three black pairs of images: enough for a program to start.
inline void write_dataset(const std::filesystem::path& folder) {
  using std::chrono::milliseconds;
  const Timestamp begin(std::chrono::seconds(1'000));
  DatasetWriter writer({.folder = folder,
                        .calibration = euroc_calibration(),
                        .imu_noise = {1.7e-4, 2.0e-5, 2.0e-3, 3.0e-3},
                        .frame_rate_hz = 20.0,
                        .imu_rate_hz = 200.0});
  for (int i = 0; i < 3; ++i) {
    const cv::Mat black(480, 752, CV_8UC1, cv::Scalar(0));
    writer.add(StereoFrame{begin + milliseconds(50 * i), black, black});
  }
  for (int i = 0; i < 30; ++i) {
    writer.add(ImuSample{begin + milliseconds(5 * i), {0.0, 0.0, 0.0}, {0.0, 0.0, 9.81}});
  }
  writer.finish();
}

/// A point cloud, 3 x 3 m.
inline void write_wall(const std::filesystem::path& file, double spacing_m = 0.05) {
  constexpr int kSide = 60;
  std::ofstream stream(file);
  stream << "ply\nformat ascii 1.0\nelement vertex " << kSide * kSide
         << "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  for (int row = 0; row < kSide; ++row) {
    for (int column = 0; column < kSide; ++column) {
      stream << spacing_m * row << ' ' << spacing_m * column << " 0\n";
    }
  }
}

}  // namespace fleetloc
