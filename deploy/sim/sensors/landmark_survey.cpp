#include "deploy/sim/sensors/landmark_survey.hpp"

#include <algorithm>

#include <opencv2/imgproc.hpp>

#include "deploy/sim/sensors/camera_packet.hpp"

namespace fleetloc {
namespace {

constexpr float kMapped_m = 0.3F;
constexpr double kMinQuality = 0.01;  // of the best corner
constexpr double kApart_px = 8.0;

}  // namespace

std::optional<Eigen::Vector3d> visible_point(const RayCaster& world,
                                             const Camera& camera,
                                             const Pose& T_map_cam,
                                             const Eigen::Vector2d& pixel) {
  const auto direction = unproject(camera, pixel);
  if (!direction) return std::nullopt;
  const Eigen::Vector3d direction_map = (T_map_cam.R * *direction).normalized();
  const auto hit =
      world.first_hit({T_map_cam.p.cast<float>(), direction_map.cast<float>()}, kFarthestSeen_m);
  if (!hit) return std::nullopt;
  return T_map_cam.p + static_cast<double>(hit->distance_m) * direction_map;
}

std::vector<VisibleLandmark> visible_landmarks(const cv::Mat& gray,
                                               const RayCaster& world,
                                               const Camera& camera,
                                               const Pose& T_map_cam,
                                               int max_count) {
  std::vector<cv::Point2f> corners;
  cv::goodFeaturesToTrack(gray, corners, max_count, kMinQuality, kApart_px);
  std::vector<VisibleLandmark> landmarks;
  for (const cv::Point2f& corner : corners) {
    const auto point = visible_point(world, camera, T_map_cam, {corner.x, corner.y});
    if (point) landmarks.push_back({.pixel = corner, .p_map = *point});
  }
  return landmarks;
}

double unmapped_share(const std::vector<VisibleLandmark>& landmarks, const RayCaster& map) {
  if (landmarks.empty()) return 0.0;
  const auto unmapped =
      std::count_if(landmarks.begin(), landmarks.end(), [&](const VisibleLandmark& landmark) {
        return !map.has_surface_within(landmark.p_map.cast<float>(), kMapped_m);
      });
  return static_cast<double>(unmapped) / static_cast<double>(landmarks.size());
}

}  // namespace fleetloc
