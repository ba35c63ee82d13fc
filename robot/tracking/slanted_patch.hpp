#pragma once

#include <optional>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

#include "shared/config/config_reader.hpp"

namespace fleetloc {

struct SlantedPatchConfig {
  int radius_px;        ///< of the square that is matched
  int iterations;       ///< at most
  double converged_px;  ///< step below which they end
  double max_px;        ///< from the start; farther it is another place
  double gray_sigma;    ///< of what remains between the two images
};

SlantedPatchConfig read_slanted_patch_config(ConfigReader section);

/// Where a patch may lie.
struct SlantedLine {
  cv::Point2f start;          ///< about where its middle is
  Eigen::Vector2f direction;  ///< unit length
  double slope_sigma;         ///< of the shift's change over the patch, about zero [px per px]
};

/// Refines where the surroundings of a pixel of one image lie in another, along a line, where the
/// shift changes linearly over the patch, as it does on a plane (Lucas and Kanade with a slanted
/// patch; Gauss-Newton with the first image's gradients). A patch that is shifted as a whole finds
/// some mean over it, which on ground below the cameras is not that of its middle.
///
/// @return  nothing at an image's border, without texture and without convergence
std::optional<cv::Point2f> match_slanted(const cv::Mat& from,
                                         const cv::Mat& to,
                                         const cv::Point2f& point,
                                         const SlantedLine& line,
                                         const SlantedPatchConfig& config);

}  // namespace fleetloc
