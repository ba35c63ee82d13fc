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

/// What tracks are like, measured against the world in which they were made.
struct TrackStatistics {
  double tracks_per_frame = 0.0;      ///< mean
  double median_length_frames = 0.0;  ///< of tracks that have ended
  double p90_length_frames = 0.0;
  double stereo_share = 0.0;       ///< of observations, with disparity
  double pixel_sigma = 0.0;        ///< of the change from frame to frame, by its median [px]
  double error_after_10_px = 0.0;  ///< median distance from where the first pixel's point is,
  double error_after_30_px = 0.0;  ///< after so many frames
  double disparity_sigma = 0.0;    ///< by the median [px]
  double outlier_share = 0.0;      ///< of observations, more than 3 px off
};

/// Two columns side by side, one line a figure.
void print(std::ostream& stream,
           const char* left_name,
           const TrackStatistics& left,
           const char* right_name,
           const TrackStatistics& right);

/// Takes the first pixel of each track for the image of the world's point there, and compares what
/// follows with that point.
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
