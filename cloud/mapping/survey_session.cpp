#include "cloud/mapping/survey_session.hpp"

#include <string>

#include "shared/trajectory/tum_file.hpp"

namespace fleetloc {
namespace {

std::filesystem::path lidar_folder(const std::filesystem::path& dataset) {
  auto folder = dataset / "mav0" / "lidar0";
  if (!std::filesystem::is_directory(folder)) {
    throw DatasetError(folder.string() + ": missing; a map is made of lidar scans");
  }
  return folder;
}

Trajectory survey_poses(const std::filesystem::path& dataset) {
  const auto folder = dataset / "mav0" / "state_groundtruth_estimate0";
  auto file = folder / "data.csv";
  if (!std::filesystem::is_regular_file(file)) file = folder / "data.tum";
  if (!std::filesystem::is_regular_file(file)) {
    throw DatasetError(folder.string() + ": neither data.csv nor data.tum; a map needs poses");
  }
  try {
    Trajectory poses = read_trajectory(file);
    if (poses.empty()) throw DatasetError(file.string() + ": holds no pose");
    return poses;
  } catch (const TrajectoryFileError& error) {
    throw DatasetError(error.what());
  }
}

}  // namespace

std::optional<std::vector<LidarRay>> deskewed(const LidarScan& scan,
                                              const LidarCalibration& lidar,
                                              const Trajectory& T_map_body,
                                              Duration max_gap) {
  const auto lidar_pose = [&](int column) -> std::optional<Pose> {
    const Timestamp stamp = scan.stamp + from_seconds(lidar.column_time_s(column));
    const auto body = interpolate(T_map_body, stamp, max_gap);
    if (!body) return std::nullopt;
    return *body * lidar.T_body_lidar;
  };
  if (!lidar_pose(0) || !lidar_pose(lidar.columns - 1)) return std::nullopt;
  std::vector<LidarRay> rays;
  rays.reserve(scan.points.size());
  std::optional<Pose> T_map_lidar;
  int column = -1;
  for (const LidarPoint& point : scan.points) {
    if (point.column != column) {
      column = point.column;
      T_map_lidar = lidar_pose(column);
    }
    if (!T_map_lidar) return std::nullopt;
    rays.push_back(
        {.origin_map = T_map_lidar->p, .p_map = *T_map_lidar * point.p_lidar.cast<double>()});
  }
  return rays;
}

SurveySession::SurveySession(const std::filesystem::path& dataset, Duration max_gap)
    : dataset_(dataset),
      lidar_(lidar_folder(dataset)),
      trajectory_(survey_poses(dataset)),
      max_gap_(max_gap) {
  if (lidar_.size() == 0) {
    throw DatasetError((lidar_folder(dataset) / "data.csv").string() + ": lists no scan");
  }
}

std::optional<std::vector<LidarRay>> SurveySession::scan(std::size_t index) const {
  return deskewed(lidar_.scan(index), lidar_.calibration(), trajectory_, max_gap_);
}

}  // namespace fleetloc
