#pragma once

#include <cstddef>
#include <iosfwd>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "deploy/sim/sensors/anchored_point.hpp"
#include "shared/model/camera.hpp"
#include "shared/model/observation.hpp"

namespace fleetloc {

/// Statistics of tracks, by the world in which they were made.
struct TrackStatistics {
  double tracks_per_frame = 0.0;      ///< mean
  double median_length_frames = 0.0;  ///< of tracks that have ended
  double p90_length_frames = 0.0;
  double stereo_share = 0.0;       ///< of observations, with disparity
  double pixel_sigma = 0.0;        ///< of the change from frame to frame, by its median [px]
  double error_after_10_px = 0.0;  ///< median reprojection error of the landmark,
  double error_after_30_px = 0.0;  ///< after this many frames; see TrackAssessment
  double disparity_sigma = 0.0;    ///< by the median [px]
  double outlier_share = 0.0;      ///< of observations, more than 3 px off
};

/// Two columns side by side, one line a figure.
void print(std::ostream& stream,
           const char* left_name,
           const TrackStatistics& left,
           const char* right_name,
           const TrackStatistics& right);

/// The landmark of a track is the point of the world at its first pixel; later observations are
/// compared with its projection.
class TrackAssessment {
 public:
  explicit TrackAssessment(RectifiedStereo stereo) : stereo_(std::move(stereo)) {}

  /// Frames in the order of time, with the true poses.
  void add(const TrackedFrame& frame, const Pose& T_map_body, const SceneView& world);

  [[nodiscard]] TrackStatistics statistics() const;

 private:
  struct Track {
    std::optional<AnchoredPoint> point;  // nothing: the first pixel showed no surface
    Eigen::Vector2d last_error = Eigen::Vector2d::Zero();
    std::size_t length = 0;
    std::size_t last_frame = 0;
  };

  void compare(Track& track,
               const StereoObservation& seen,
               const Pose& T_map_body,
               const SceneView& world);

  RectifiedStereo stereo_;
  std::size_t frames_ = 0;
  std::map<LandmarkId, Track> tracks_;
  std::vector<double> changes_px_;
  std::vector<double> after_10_px_;
  std::vector<double> after_30_px_;
  std::vector<double> disparity_errors_px_;
  std::size_t observations_ = 0;
  std::size_t with_disparity_ = 0;
  std::size_t outliers_ = 0;
};

}  // namespace fleetloc
