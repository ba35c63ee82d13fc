#pragma once

#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "shared/config/config_reader.hpp"

namespace fleetloc {

struct OpticalFlowConfig {
  int window_px;         ///< side of the square that is matched, odd
  int levels;            ///< of the pyramids, beside the image itself; each halves the size
  int iterations;        ///< at most, per level
  double converged_px;   ///< step below which an iteration ends
  double round_trip_px;  ///< forward-backward check: largest distance from the start
};

OpticalFlowConfig read_optical_flow_config(ConfigReader section);

/// An image (8 bit gray), half of it, a quarter, ..., each with its gradient. Built once per image.
class ImagePyramid {
 public:
  ImagePyramid() = default;
  ImagePyramid(const cv::Mat& image, const OpticalFlowConfig& config);

  [[nodiscard]] bool empty() const { return images_and_gradients_.empty(); }
  [[nodiscard]] int levels() const { return levels_; }
  [[nodiscard]] const cv::Mat& image(int level = 0) const;
  [[nodiscard]] const std::vector<cv::Mat>& images_and_gradients() const {
    return images_and_gradients_;
  }

 private:
  int levels_ = 0;
  std::vector<cv::Mat> images_and_gradients_;  // of level 0, level 1, ...
};

/// Tracks `points` of `from` to `to` [px] by pyramidal Lucas-Kanade, one result per point; nothing
/// for a point that is lost or fails the forward-backward check.
///
/// @param start  initial guesses, one per point; may be off by window_px / 2 * 2^levels
std::vector<std::optional<cv::Point2f>> track_points(const ImagePyramid& from,
                                                     const ImagePyramid& to,
                                                     const std::vector<cv::Point2f>& points,
                                                     const std::vector<cv::Point2f>& start,
                                                     const OpticalFlowConfig& config);

}  // namespace fleetloc
