#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "cloud/mapping/lidar_scan.hpp"
#include "shared/dataset/dataset_error.hpp"
#include "shared/dataset/sensor_file.hpp"

namespace fleetloc {

// The folder lidar0/ of a dataset:
//   sensor.yaml  T_BS (of the lidar on the body), rate_hz, columns, rings
//   data.csv     #timestamp [ns],filename
//   data/*.bin   one file per scan, 16 bytes per point, little endian: float32 x, y, z [m],
//                uint16 column, uint8 ring, uint8 zero; see LidarPoint for their meaning

/// Writes the folder. Everything throws DatasetError.
class LidarWriter {
 public:
  /// @param folder  e.g. mav0/lidar0; is created
  LidarWriter(const std::filesystem::path& folder, const LidarCalibration& calibration);

  /// Stamps must increase.
  void add(const LidarScan& scan);

  /// Writes out what is buffered; nothing may be added afterwards.
  void finish();

 private:
  std::filesystem::path folder_;
  std::ofstream csv_;
};

/// Reads the folder; scans are loaded one by one.
class LidarReader {
 public:
  /// Reads sensor.yaml and the list of scans. Throws DatasetError that names file and line, also
  /// where stamps do not increase or a scan is missing.
  explicit LidarReader(const std::filesystem::path& folder);

  [[nodiscard]] const LidarCalibration& calibration() const { return calibration_; }
  [[nodiscard]] std::size_t size() const { return entries_.size(); }
  [[nodiscard]] Timestamp stamp(std::size_t index) const { return entries_.at(index).stamp; }

  /// Throws DatasetError if the file is cut off or holds points that the lidar cannot have measured
  /// (not finite, no such ring or column).
  [[nodiscard]] LidarScan scan(std::size_t index) const;

 private:
  struct Entry {
    Timestamp stamp;
    std::filesystem::path file;
    std::string where;  // "data.csv:12"
  };

  LidarCalibration calibration_;
  std::vector<Entry> entries_;
};

}  // namespace fleetloc
