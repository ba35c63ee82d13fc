#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "robot/tracking/corner_detection.hpp"
#include "robot/tracking/motion_check.hpp"
#include "robot/tracking/optical_flow.hpp"
#include "robot/tracking/rectified_camera.hpp"
#include "robot/tracking/reference_patch.hpp"
#include "robot/tracking/stereo_matching.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/model/observation.hpp"
#include "shared/model/stereo_frame.hpp"

namespace fleetloc {

/// Counts and errors of the features of one frame.
struct TrackingDiagnostics {
  int tracked = 0;               ///< from the last left image, forward-backward check passed
  int lost = 0;                  ///< the others
  int rejected_by_motion = 0;    ///< of those tracked: outliers of the rigid motion
  int detected = 0;              ///< new
  int with_disparity = 0;        ///< of all
  double row_error_px = 0.0;     ///< median |difference| of left and right rectified row
  double motion_error_px = 0.0;  ///< median distance from the pixel predicted by the motion
};

/// Tracks point features through the images of a stereo camera. Deterministic; programs that
/// need bit-identical replays and no extra threads call cv::setNumThreads(1) once.
class FeatureTracker {
 public:
  struct Config {
    CornerDetectionConfig corners;
    OpticalFlowConfig flow;
    ReferencePatchConfig reference;  ///< refines flow
    SlantedPatchConfig slanted;      ///< refines stereo
    MotionCheckConfig motion;
    StereoMatchingConfig stereo;
  };

  FeatureTracker(const StereoCalibration& calibration, const Config& config);

  /// Observations in the rectified pair. Landmark ids increase and are never used twice. Without a
  /// left image there are none, and the next one is tracked from the last left image; without a
  /// right image there are no disparities.
  ///
  /// @param R_previous_current  rotation of the body since the previous call, from the gyroscope;
  ///                            identity if it is not known
  /// Throws std::invalid_argument if an image is not 8 bit gray or not of the calibrated size.
  TrackedFrame track(const StereoFrame& frame, const Eigen::Quaterniond& R_previous_current);

  /// Of the last call.
  [[nodiscard]] const TrackingDiagnostics& diagnostics() const { return diagnostics_; }

 private:
  /// How a feature was seen when its patch was cut out.
  struct Reference {
    ReferencePatch patch;
    Eigen::Matrix2d J_rectified_pixel;
    Eigen::Quaterniond R_left_first;
    double disparity;  // 0: not known
  };

  struct Track {
    LandmarkId landmark;
    cv::Point2f left;           // in the image
    Eigen::Vector2d rectified;  // the same in the rectified pair
    double disparity = 0.0;     // 0: not known
    std::optional<Reference> reference;
  };

  void track_features(const ImagePyramid& left, const Eigen::Quaterniond& R_previous_current);
  void keep_inliers(std::vector<Track> tracked,
                    const std::vector<Correspondence>& correspondences,
                    const RigidMotion& motion);
  void match_right(const ImagePyramid& left, const cv::Mat& right);
  [[nodiscard]] bool is_taken(const cv::Point2f& pixel) const;
  void add_corners(const cv::Mat& left);
  [[nodiscard]] Pose predict_motion(const Eigen::Quaterniond& R_previous_current) const;
  [[nodiscard]] cv::Point2f predict_pixel(const Track& track, const Pose& T) const;
  [[nodiscard]] cv::Point2f refined(const cv::Mat& left,
                                    Track& track,
                                    const cv::Point2f& flown) const;
  [[nodiscard]] std::optional<Eigen::Matrix2f> predict_warp(const Reference& reference,
                                                            const cv::Point2f& pixel,
                                                            double disparity) const;
  void cut_references(const cv::Mat& left);
  [[nodiscard]] TrackedFrame observe(Timestamp stamp) const;

  Config config_;
  RectifiedStereo stereo_;
  RectifiedCamera left_camera_;
  StereoMatcher matcher_;

  ImagePyramid left_;                   // the last one
  std::vector<Track> tracks_;           // in it, strictly increasing by landmark
  Eigen::Quaterniond R_left_previous_;  // of the body: from that image to the previous call
  Eigen::Quaterniond R_left_first_;     // of the rectified camera: from the first image to that one
  Eigen::Vector3d translation_m_;       // of the last T_current_previous, if known
  std::uint32_t next_landmark_ = 0;
  TrackingDiagnostics diagnostics_;
};

FeatureTracker::Config read_feature_tracker_config(ConfigReader section);

}  // namespace fleetloc
