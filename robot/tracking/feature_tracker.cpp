#include "robot/tracking/feature_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "shared/core/percentile.hpp"

namespace fleetloc {
namespace {

void check_image(const cv::Mat& image, const Camera& camera, const char* side) {
  if (image.empty()) return;
  if (image.type() != CV_8UC1 || image.cols != camera.width_px || image.rows != camera.height_px) {
    throw std::invalid_argument(std::string(side) + " image: must be 8 bit gray and of " +
                                std::to_string(camera.width_px) + "x" +
                                std::to_string(camera.height_px) + " pixels as calibrated");
  }
}

}  // namespace

FeatureTracker::Config read_feature_tracker_config(ConfigReader section) {
  return {.corners = read_corner_detection_config(section.section("corners")),
          .flow = read_optical_flow_config(section.section("flow")),
          .reference = read_reference_patch_config(section.section("reference")),
          .slanted = read_slanted_patch_config(section.section("slanted")),
          .motion = read_motion_check_config(section.section("motion")),
          .stereo = read_stereo_matching_config(section.section("stereo"))};
}

FeatureTracker::FeatureTracker(const StereoCalibration& calibration, const Config& config)
    : config_(config),
      stereo_(rectified(calibration)),
      left_camera_(calibration.cam0, calibration.T_body_cam0.R, stereo_),
      matcher_(stereo_,
               RectifiedCamera(calibration.cam1, calibration.T_body_cam1.R, stereo_),
               config.flow,
               config.slanted,
               config.stereo),
      R_left_previous_(Eigen::Quaterniond::Identity()),
      R_left_first_(Eigen::Quaterniond::Identity()),
      translation_m_(Eigen::Vector3d::Zero()) {}

TrackedFrame FeatureTracker::track(const StereoFrame& frame,
                                   const Eigen::Quaterniond& R_previous_current) {
  check_image(frame.left, left_camera_.camera(), "left");
  check_image(frame.right, matcher_.right_camera().camera(), "right");
  diagnostics_ = {};
  R_left_previous_ = (R_left_previous_ * R_previous_current).normalized();
  if (frame.left.empty()) return {.stamp = frame.stamp, .observations = {}};

  ImagePyramid left(frame.left, config_.flow);
  if (!left_.empty()) track_features(left, R_left_previous_);
  add_corners(frame.left);
  match_right(left, frame.right);
  cut_references(frame.left);
  left_ = std::move(left);
  R_left_previous_.setIdentity();
  return observe(frame.stamp);
}

/// Constant velocity; rotation from the gyroscope.
Pose FeatureTracker::predict_motion(const Eigen::Quaterniond& R_previous_current) const {
  const Eigen::Quaterniond& R_body_cam = stereo_.T_body_cam0.R;
  Pose T_current_previous;
  T_current_previous.R = R_body_cam.conjugate() * R_previous_current.conjugate() * R_body_cam;
  T_current_previous.p = translation_m_;
  return T_current_previous;
}

/// Predicted pixel of the track; its last pixel if that is outside of the image.
cv::Point2f FeatureTracker::predict_pixel(const Track& track, const Pose& T) const {
  const Eigen::Vector3d ray =
      ((track.rectified - stereo_.center_px) / stereo_.focal_px).homogeneous();
  Eigen::Vector3d moved = T.R * ray;
  if (track.disparity > 0.0) {
    moved += T.p * (track.disparity / (stereo_.focal_px * stereo_.baseline_m));
  }
  if (moved.z() <= 0.0) return track.left;
  const Eigen::Vector2d rectified =
      stereo_.center_px + moved.head<2>() * (stereo_.focal_px / moved.z());
  return left_camera_.distort(rectified).value_or(track.left);
}

void FeatureTracker::track_features(const ImagePyramid& left,
                                    const Eigen::Quaterniond& R_previous_current) {
  const Pose prediction = predict_motion(R_previous_current);
  R_left_first_ = (prediction.R * R_left_first_).normalized();
  std::vector<cv::Point2f> points;
  std::vector<cv::Point2f> starts;
  for (const auto& track : tracks_) {
    points.push_back(track.left);
    starts.push_back(predict_pixel(track, prediction));
  }
  const auto moved = track_points(left_, left, points, starts, config_.flow);
  std::vector<Track> tracked;
  std::vector<Correspondence> correspondences;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (!moved[i]) continue;
    Track& track = tracks_[i];
    const Eigen::Vector2d before = track.rectified;
    track.left = refined(left.image(), track, *moved[i]);
    const auto rectified = left_camera_.rectify(track.left);
    if (!rectified) continue;
    track.rectified = *rectified;
    correspondences.push_back({before, track.rectified, track.disparity});
    tracked.push_back(std::move(track));
  }
  diagnostics_.tracked = static_cast<int>(tracked.size());
  diagnostics_.lost = static_cast<int>(tracks_.size() - tracked.size());
  const auto checked = estimate_rigid_motion(correspondences, stereo_, prediction, config_.motion);
  keep_inliers(std::move(tracked), correspondences, checked);
}

/// Refines by the reference; one that no longer looks the same is given up.
cv::Point2f FeatureTracker::refined(const cv::Mat& left,
                                    Track& track,
                                    const cv::Point2f& flown) const {
  if (!track.reference) return flown;
  const auto warp = predict_warp(*track.reference, flown, track.disparity);
  const auto pixel =
      warp ? track.reference->patch.match(left, flown, *warp, config_.reference) : std::nullopt;
  if (!pixel) track.reference.reset();
  return pixel.value_or(flown);
}

/// Of a surface that faced the camera in the reference.
std::optional<Eigen::Matrix2f> FeatureTracker::predict_warp(const Reference& reference,
                                                            const cv::Point2f& pixel,
                                                            double disparity) const {
  const auto rectified = left_camera_.rectify(pixel);
  const auto J_rectified_pixel = left_camera_.rectify_jacobian(pixel);
  if (!rectified || !J_rectified_pixel) return std::nullopt;
  const Eigen::Vector2d ideal = (*rectified - stereo_.center_px) / stereo_.focal_px;
  Eigen::Matrix<double, 2, 3> projection;
  projection << Eigen::Matrix2d::Identity(), -ideal;
  const Eigen::Matrix3d R = (R_left_first_ * reference.R_left_first.conjugate()).toRotationMatrix();
  const bool is_deep = disparity > 0.0 && reference.disparity > 0.0;
  const double zoom = is_deep ? disparity / reference.disparity : 1.0;
  return (J_rectified_pixel->inverse() * zoom * projection * R.leftCols<2>() *
          reference.J_rectified_pixel)
      .cast<float>();
}

/// Of the tracks that have none.
void FeatureTracker::cut_references(const cv::Mat& left) {
  for (auto& track : tracks_) {
    if (track.reference) continue;
    auto patch = ReferencePatch::cut(left, track.left, config_.reference.radius_px);
    if (!patch) continue;
    const auto J = left_camera_.rectify_jacobian(track.left);
    if (J) track.reference = {std::move(*patch), *J, R_left_first_, track.disparity};
  }
}

/// Keeps the inliers of the rigid motion, each with its predicted disparity.
void FeatureTracker::keep_inliers(std::vector<Track> tracked,
                                  const std::vector<Correspondence>& correspondences,
                                  const RigidMotion& motion) {
  tracks_.clear();
  for (std::size_t i = 0; i < tracked.size(); ++i) {
    Track& track = tracked[i];
    if (!motion.inliers[i] || is_taken(track.left)) continue;
    if (track.disparity > 0.0) {
      const Eigen::Vector2d ideal =
          (correspondences[i].previous - stereo_.center_px) / stereo_.focal_px;
      const double depth = stereo_.focal_px * stereo_.baseline_m / track.disparity;
      const double depth_now = (motion.T_current_previous * (depth * ideal.homogeneous())).z();
      track.disparity *= motion.has_translation && depth_now > 0.0 ? depth / depth_now : 1.0;
    }
    tracks_.push_back(std::move(track));
  }
  diagnostics_.rejected_by_motion =
      static_cast<int>(std::count(motion.inliers.begin(), motion.inliers.end(), false));
  diagnostics_.motion_error_px = percentile(motion.distances_px, 0.5).value_or(0.0);
  translation_m_ = motion.has_translation ? motion.T_current_previous.p : Eigen::Vector3d::Zero();
}

/// Of two features that have converged to one pixel the older stays.
bool FeatureTracker::is_taken(const cv::Point2f& pixel) const {
  const double distance = 0.5 * config_.corners.min_distance_px;
  return std::any_of(tracks_.begin(), tracks_.end(), [&](const Track& track) {
    return cv::norm(track.left - pixel) < distance;
  });
}

void FeatureTracker::add_corners(const cv::Mat& left) {
  std::vector<cv::Point2f> present;
  for (const auto& track : tracks_) present.push_back(track.left);
  for (const auto& corner : detect_corners(left, present, config_.corners)) {
    const auto rectified = left_camera_.rectify(corner);
    if (!rectified) continue;
    tracks_.push_back({LandmarkId{next_landmark_++}, corner, *rectified, 0.0, std::nullopt});
    ++diagnostics_.detected;
  }
}

void FeatureTracker::match_right(const ImagePyramid& left, const cv::Mat& right) {
  std::vector<StereoMatch> matches(tracks_.size());
  if (!right.empty()) {
    std::vector<StereoQuery> queries;
    for (const auto& track : tracks_) {
      queries.push_back({track.left, track.rectified, track.disparity});
    }
    matches = matcher_.match(left, ImagePyramid(right, config_.flow), queries);
  }
  std::vector<double> row_errors;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    tracks_[i].disparity = matches[i].disparity;
    if (matches[i].disparity > 0.0) row_errors.push_back(std::abs(matches[i].row_error_px));
  }
  diagnostics_.with_disparity = static_cast<int>(row_errors.size());
  diagnostics_.row_error_px = percentile(std::move(row_errors), 0.5).value_or(0.0);
}

TrackedFrame FeatureTracker::observe(Timestamp stamp) const {
  TrackedFrame frame{.stamp = stamp, .observations = {}};
  for (const auto& track : tracks_) {
    frame.observations.push_back({track.landmark, track.rectified, track.disparity});
  }
  return frame;
}

}  // namespace fleetloc
