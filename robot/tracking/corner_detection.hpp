#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "shared/config/config_reader.hpp"

namespace fleetloc {

struct CornerDetectionConfig {
  int features;            ///< wanted in an image
  int refill_below;        ///< nothing is detected while there are as many
  int columns;             ///< of the grid over which features are spread
  int rows;                ///< of the same
  int fast_threshold;      ///< gray values by which a corner stands out
  double min_score;        ///< smaller eigenvalue of the mean gradient products [gray^2 / px^2]
  double min_distance_px;  ///< between two features
  int margin_px;           ///< border of the image without features
};

CornerDetectionConfig read_corner_detection_config(ConfigReader section);

/// New corners for the emptiest cells of the grid, FAST corners by their Shi-Tomasi score, until
/// there are as many features as wanted. `present` are those that the image already has.
std::vector<cv::Point2f> detect_corners(const cv::Mat& image,
                                        const std::vector<cv::Point2f>& present,
                                        const CornerDetectionConfig& config);

}  // namespace fleetloc
