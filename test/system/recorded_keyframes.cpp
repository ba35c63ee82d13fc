#include "test/system/recorded_keyframes.hpp"

#include <cmath>
#include <optional>
#include <utility>
#include <variant>

#include <opencv2/core/utility.hpp>

#include "cloud/laser_map/build_map.hpp"
#include "cloud/point_cloud/point_cloud_file.hpp"
#include "deploy/config/default_config.hpp"
#include "robot/dataset/dataset_reader.hpp"
#include "robot/tracking/feature_tracker.hpp"
#include "shared/core/counter_random.hpp"
#include "shared/geometry/so3.hpp"
#include "shared/trajectory/tum_file.hpp"

namespace fleetloc {
namespace {

enum Stream : std::uint64_t { kStartShift = 1, kStartTurn, kEdgeShift, kEdgeTurn, kTilt };

constexpr std::uint32_t kIdsPerKeyframe = 100'000;
constexpr double kMinEdgeSigma = 0.001;  // [m]

FeatureTracker::Config tracking_config(const std::string& yaml) {
  auto config = ConfigReader::from_string(default_config("robot"));
  config.overlay(ConfigReader::from_string("tracking: " + yaml));
  return read_feature_tracker_config(config.section("tracking"));
}

std::shared_ptr<const LaserMap> map_of_scan(const std::filesystem::path& dataset) {
  const auto points = read_points(dataset / "mav0" / "pointcloud0" / "data.ply");
  auto config = ConfigReader::from_string(default_config("map"));
  return std::make_shared<const LaserMap>(
      build_map(points, "map", read_map_config(config.section("map"))));
}

// Of length one.
Eigen::Vector3d direction(std::uint64_t seed, Stream stream, std::size_t index) {
  return CounterRandom(seed, stream).normal3(index).normalized();
}

Eigen::Matrix3d isotropic(double magnitude) {
  return magnitude * magnitude / 3.0 * Eigen::Matrix3d::Identity();
}

Matrix6d covariance_of(double rotation_rad, double translation_m) {
  Matrix6d covariance = Matrix6d::Zero();
  covariance.topLeftCorner<3, 3>() = isotropic(rotation_rad);
  covariance.bottomRightCorner<3, 3>() = isotropic(translation_m);
  return covariance;
}

Vector6d disturbance_of(const Eigen::Vector3d& rotation, const Eigen::Vector3d& translation) {
  Vector6d xi;
  xi << rotation, translation;
  return xi;
}

VirtualEdge edge_between(const RecordedKeyframe& from,
                         const RecordedKeyframe& to,
                         std::size_t index_of_to,
                         const Disturbance& disturbance) {
  const Pose T_from_to = inverse(from.T_map_body) * to.T_map_body;
  const double shift_m = disturbance.edge_m_per_m * T_from_to.p.norm();
  VirtualEdge edge;
  edge.T_from_to = retract(
      T_from_to,
      disturbance_of(disturbance.edge_rad * direction(disturbance.seed, kEdgeTurn, index_of_to),
                     shift_m * direction(disturbance.seed, kEdgeShift, index_of_to)));
  edge.information =
      covariance_of(disturbance.edge_rad, std::hypot(shift_m, kMinEdgeSigma)).inverse();
  return edge;
}

// Turned about a horizontal axis.
Pose tilted(const Pose& T_map_body, std::size_t index, const Disturbance& disturbance) {
  Eigen::Vector3d axis = direction(disturbance.seed, kTilt, index);
  axis.z() = 0.0;
  return {exp_so3(disturbance.tilt_rad * axis.normalized()) * T_map_body.R, T_map_body.p};
}

}  // namespace

RecordedKeyframes read_keyframes(const std::filesystem::path& dataset,
                                 const std::string& tracking) {
  cv::setNumThreads(1);
  constexpr std::chrono::milliseconds kMaxGap{100};
  const auto truth = read_trajectory(dataset / "mav0" / "state_groundtruth_estimate0" / "data.csv");
  const auto config = tracking_config(tracking);
  DatasetReader reader({.folder = dataset});
  RecordedKeyframes result{
      .stereo = rectified(reader.calibration()), .keyframes = {}, .map = map_of_scan(dataset)};
  while (const auto item = reader.next()) {
    const auto* cameras = std::get_if<CameraFrame>(&*item);
    if (cameras == nullptr) continue;
    const auto* frame = &std::get<StereoFrame>(*cameras);
    const auto T_map_body = interpolate(truth, frame->stamp, kMaxGap);
    if (!T_map_body) continue;
    FeatureTracker tracker(reader.calibration(), config);
    TrackedFrame tracked = tracker.track(*frame, Eigen::Quaterniond::Identity());
    std::erase_if(tracked.observations, [](const auto& seen) { return seen.disparity <= 0.0; });
    const auto base = static_cast<std::uint32_t>(result.keyframes.size()) * kIdsPerKeyframe;
    for (StereoObservation& seen : tracked.observations) {
      seen.landmark = LandmarkId{base + static_cast<std::uint32_t>(seen.landmark)};
    }
    result.keyframes.push_back({frame->stamp, *T_map_body, std::move(tracked.observations)});
  }
  return result;
}

KeyframeRun::KeyframeRun(const RecordedKeyframes& recorded,
                         std::size_t first,
                         std::size_t count,
                         const Disturbance& disturbance)
    : truth_(recorded.keyframes[first + count - 1].T_map_body) {
  const Pose& T_map_first = recorded.keyframes[first].T_map_body;
  Pose T_odom_body = tilted(T_map_first, first, disturbance);
  const Pose T_map_odom{T_map_first.R * T_odom_body.R.conjugate(), T_map_first.p};
  T_odom_body.p.setZero();
  session_.stereo = recorded.stereo;
  const Vector6d start =
      disturbance_of(disturbance.start_rad * direction(disturbance.seed, kStartTurn, first),
                     disturbance.start_m * direction(disturbance.seed, kStartShift, first));
  session_.start = MapOdomEstimate{retract(T_map_odom, start),
                                   covariance_of(disturbance.start_rad, disturbance.start_m)};
  for (std::size_t i = first; i < first + count; ++i) {
    const RecordedKeyframe& keyframe = recorded.keyframes[i];
    Submap submap;
    if (i > first) {
      VirtualEdge edge = edge_between(recorded.keyframes[i - 1], keyframe, i, disturbance);
      edge.from = KeyframeId{static_cast<std::uint32_t>(i - 1)};
      edge.to = KeyframeId{static_cast<std::uint32_t>(i)};
      T_odom_body = T_odom_body * edge.T_from_to;
      submap.edges.push_back(edge);
    }
    SubmapKeyframe item;
    item.id = KeyframeId{static_cast<std::uint32_t>(i)};
    item.stamp = keyframe.stamp;
    item.T_odom_body = T_odom_body;
    item.tilt_sigma = disturbance.tilt_rad;
    item.observations = keyframe.observations;
    submap.keyframes.push_back(std::move(item));
    submaps_.push_back(std::move(submap));
  }
}

}  // namespace fleetloc
