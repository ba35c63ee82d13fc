#pragma once

#include <optional>
#include <vector>

#include "robot/tracking/optical_flow.hpp"
#include "robot/tracking/rectified_camera.hpp"
#include "robot/tracking/slanted_patch.hpp"
#include "shared/config/config_reader.hpp"

namespace fleetloc {

struct StereoMatchingConfig {
  int levels;               ///< of the pyramids, for a start at a predicted disparity
  double round_trip_px;     ///< forward-backward check, left to right and back
  double row_error_px;      ///< largest difference of the rectified rows
  double min_disparity_px;  ///< farther points count as not seen by the right camera
  double nearest_m;         ///< smallest possible depth
  double min_correlation;   ///< of the search without a prediction, 0 to 1
  double min_likeness;      ///< correlation of a refined patch with its match, 0 to 1
  double slant_sigma;       ///< tangent of the angle between surface normal and view
};

StereoMatchingConfig read_stereo_matching_config(ConfigReader section);

/// A feature of the left image for which the right image is searched.
struct StereoQuery {
  cv::Point2f left;           ///< in the image
  Eigen::Vector2d rectified;  ///< the same in the rectified pair
  double disparity = 0.0;     ///< predicted; 0: not known [px of the rectified pair]
};

struct StereoMatch {
  double disparity = 0.0;     ///< 0: not found in the right image
  double row_error_px = 0.0;  ///< right row - left row, if found
};

/// Finds features of the left image in the right one, one result per query.
class StereoMatcher {
 public:
  StereoMatcher(const RectifiedStereo& stereo,
                RectifiedCamera right_camera,
                const OpticalFlowConfig& flow,
                const SlantedPatchConfig& slanted,
                const StereoMatchingConfig& config);

  [[nodiscard]] std::vector<StereoMatch> match(const ImagePyramid& left,
                                               const ImagePyramid& right,
                                               const std::vector<StereoQuery>& queries) const;

  [[nodiscard]] const RectifiedCamera& right_camera() const { return right_camera_; }

 private:
  /// Coarse search along the row; 0 if nothing correlates.
  [[nodiscard]] double search(const ImagePyramid& left,
                              const ImagePyramid& right,
                              const StereoQuery& query) const;

  /// Refined along the row; nothing where that fails, or where the patch is not of one surface.
  [[nodiscard]] std::optional<cv::Point2f> refined(const ImagePyramid& left,
                                                   const ImagePyramid& right,
                                                   const StereoQuery& query,
                                                   const cv::Point2f& match) const;

  RectifiedCamera right_camera_;
  OpticalFlowConfig flow_;
  SlantedPatchConfig slanted_;
  StereoMatchingConfig config_;
  double max_disparity_px_;
  double focal_px_;
};

}  // namespace fleetloc
