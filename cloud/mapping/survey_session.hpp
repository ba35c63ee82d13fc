#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "cloud/mapping/lidar_file.hpp"
#include "shared/dataset/sensor_file.hpp"
#include "shared/trajectory/trajectory.hpp"

namespace fleetloc {

/// A ray of the lidar, deskewed: its origin and the measured point, both in map [m].
struct LidarRay {
  Eigen::Vector3d origin_map;
  Eigen::Vector3d p_map;
};

/// The lidar scans of a dataset, deskewed: each point is transformed by the body's pose at the
/// point's own time.
class SurveySession {
 public:
  /// @param dataset  holds mav0/lidar0 and the poses of the survey: data.csv or data.tum in
  ///                 mav0/state_groundtruth_estimate0
  /// @param max_gap  between neighbouring poses; longer ones are not interpolated
  /// Throws DatasetError that names the file, and the line if it has one.
  SurveySession(const std::filesystem::path& dataset, Duration max_gap);

  [[nodiscard]] const std::filesystem::path& dataset() const { return dataset_; }
  [[nodiscard]] std::size_t scans() const { return lidar_.size(); }

  /// Its points in map; nothing if the poses do not cover the whole scan. Throws DatasetError.
  [[nodiscard]] std::optional<std::vector<LidarRay>> scan(std::size_t index) const;

 private:
  std::filesystem::path dataset_;
  LidarReader lidar_;
  Trajectory trajectory_;
  Duration max_gap_;
};

/// Deskews a scan by the given poses; nothing if they do not cover the whole scan.
std::optional<std::vector<LidarRay>> deskewed(const LidarScan& scan,
                                              const LidarCalibration& lidar,
                                              const Trajectory& T_map_body,
                                              Duration max_gap);

}  // namespace fleetloc
