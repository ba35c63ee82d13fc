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
  double max_px;        ///< largest distance from the start
  double gray_sigma;    ///< of what remains between the two images
};

SlantedPatchConfig read_slanted_patch_config(ConfigReader section);

/// The line along which a patch is searched.
struct SearchLine {
  cv::Point2f start;          ///< initial guess of the patch center
  Eigen::Vector2f direction;  ///< unit length
  double slope_sigma;         ///< of the shift's change over the patch, about zero [px per px]
};

struct SlantedMatch {
  cv::Point2f pixel;       ///< of the patch's center
  Eigen::Vector2f slopes;  ///< of the shift, along the patch's columns and rows [px per px]
};

/// Refines the match of a patch along a line, with a shift that changes linearly over the patch, as
/// on a plane (Lucas-Kanade with a slanted patch; Gauss-Newton with the first image's gradients). A
/// purely translated patch would give a mean of the shift, which on the ground is not that of the
/// center.
///
/// @return  nothing at an image's border, without texture and without convergence
std::optional<SlantedMatch> match_slanted(const cv::Mat& from,
                                          const cv::Mat& to,
                                          const cv::Point2f& point,
                                          const SearchLine& line,
                                          const SlantedPatchConfig& config);

/// How much a patch looks like its match along `direction`: the correlation of their gray values,
/// of zero mean. Near 1 if the patch is of one surface; where it is the edge of a near surface
/// before a far one, no single shift brings all of it to match.
/// @return  -1..1; -1 at an image's border
float correlation(const cv::Mat& from,
                  const cv::Mat& to,
                  const cv::Point2f& point,
                  const Eigen::Vector2f& direction,
                  const SlantedMatch& match,
                  int radius_px);

}  // namespace fleetloc
