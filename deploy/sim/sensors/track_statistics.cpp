#include "deploy/sim/sensors/track_statistics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <numbers>
#include <ostream>
#include <utility>

#include "shared/core/percentile.hpp"

namespace fleetloc {
namespace {

constexpr double kOutlierPx = 3.0;
constexpr double kFarthestM = 500.0;
constexpr double kSigmaOfMedian = 1.4826;  // of |normal numbers|
constexpr double kRayleighSigma = 0.8493;  // sigma of each axis by the median distance

double quantile(const std::vector<double>& values, double share) {
  return percentile(values, share).value_or(0.0);
}

double ratio(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

void print(std::ostream& stream,
           const char* left_name,
           const TrackStatistics& left,
           const char* right_name,
           const TrackStatistics& right) {
  struct Row {
    const char* name;
    double TrackStatistics::*value;
  };
  constexpr std::array kRows{Row{"tracks per frame", &TrackStatistics::tracks_per_frame},
                             Row{"length median [frames]", &TrackStatistics::median_length_frames},
                             Row{"length p90 [frames]", &TrackStatistics::p90_length_frames},
                             Row{"share with disparity", &TrackStatistics::stereo_share},
                             Row{"sigma frame to frame [px]", &TrackStatistics::pixel_sigma},
                             Row{"error after 10 frames [px]", &TrackStatistics::error_after_10_px},
                             Row{"error after 30 frames [px]", &TrackStatistics::error_after_30_px},
                             Row{"disparity sigma [px]", &TrackStatistics::disparity_sigma},
                             Row{"share off by over 3 px", &TrackStatistics::outlier_share}};
  constexpr int kName = 28;
  constexpr int kValue = 14;
  stream << std::setw(kName) << std::left << "" << std::right << std::setw(kValue) << left_name
         << std::setw(kValue) << right_name << '\n';
  for (const Row& row : kRows) {
    stream << std::setw(kName) << std::left << row.name << std::right << std::setw(kValue)
           << left.*row.value << std::setw(kValue) << right.*row.value << '\n';
  }
}

void TrackAssessment::compare(Track& track,
                              const StereoObservation& seen,
                              const Pose& T_map_body,
                              const SceneView& world) {
  const Eigen::Vector3d p_cam0 =
      inverse(T_map_body * stereo_.T_body_cam0) * p_map(*track.point, world);
  if (p_cam0.z() <= 0.0) return;
  const Eigen::Vector3d ideal = project(stereo_, p_cam0);
  const Eigen::Vector2d error = seen.left - ideal.head<2>();
  if (track.length > 1) changes_px_.push_back((error - track.last_error).norm());
  track.last_error = error;
  outliers_ += error.norm() > kOutlierPx ? 1U : 0U;
  constexpr std::size_t kTenLater = 11;
  constexpr std::size_t kThirtyLater = 31;
  if (track.length == kTenLater) after_10_px_.push_back(error.norm());
  if (track.length == kThirtyLater) after_30_px_.push_back(error.norm());
  if (seen.disparity > 0.0) {
    disparity_errors_px_.push_back(std::abs(seen.disparity - (ideal.x() - ideal.z())));
  }
}

void TrackAssessment::add(const TrackedFrame& frame,
                          const Pose& T_map_body,
                          const SceneView& world) {
  const Pose T_map_cam0 = T_map_body * stereo_.T_body_cam0;
  for (const StereoObservation& seen : frame.observations) {
    Track& track = tracks_[seen.landmark];
    ++track.length;
    track.last_frame = frames_;
    ++observations_;
    with_disparity_ += seen.disparity > 0.0 ? 1U : 0U;
    if (track.length == 1) {
      const Eigen::Vector2d tangent = (seen.left - stereo_.center_px) / stereo_.focal_px;
      const Eigen::Vector3d direction_map = T_map_cam0.R * tangent.homogeneous().normalized();
      track.point = first_point(T_map_cam0.p, direction_map, kFarthestM, world);
    } else if (track.point) {
      compare(track, seen, T_map_body, world);
    }
  }
  ++frames_;
}

TrackStatistics TrackAssessment::statistics() const {
  std::vector<double> lengths;
  for (const auto& [landmark, track] : tracks_) {
    if (track.last_frame + 1 < frames_) lengths.push_back(static_cast<double>(track.length));
  }
  return {.tracks_per_frame = ratio(observations_, frames_),
          .median_length_frames = quantile(lengths, 0.5),
          .p90_length_frames = quantile(lengths, 0.9),
          .stereo_share = ratio(with_disparity_, observations_),
          .pixel_sigma = kRayleighSigma / std::numbers::sqrt2 * quantile(changes_px_, 0.5),
          .error_after_10_px = quantile(after_10_px_, 0.5),
          .error_after_30_px = quantile(after_30_px_, 0.5),
          .disparity_sigma = kSigmaOfMedian * quantile(disparity_errors_px_, 0.5),
          .outlier_share = ratio(outliers_, observations_)};
}

}  // namespace fleetloc
