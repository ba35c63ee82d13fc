#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

namespace fleetloc {

/// Gray value of an 8 bit image, bilinear; the pixel and its next ones must lie in the image.
inline float sampled(const cv::Mat& image, float x, float y) {
  const int column = static_cast<int>(x);
  const int row = static_cast<int>(y);
  const float a = x - static_cast<float>(column);
  const float b = y - static_cast<float>(row);
  const auto* upper = image.ptr<unsigned char>(row) + column;
  const auto* lower = image.ptr<unsigned char>(row + 1) + column;
  const float above = static_cast<float>(upper[0]) + a * static_cast<float>(upper[1] - upper[0]);
  const float below = static_cast<float>(lower[0]) + a * static_cast<float>(lower[1] - lower[0]);
  return above + b * (below - above);
}

/// Everything within `reach_px` can be sampled.
inline bool is_inside(const cv::Mat& image, const cv::Point2f& point, float reach_px) {
  const auto right = static_cast<float>(image.cols - 1);
  const auto bottom = static_cast<float>(image.rows - 1);
  return point.x >= reach_px && point.y >= reach_px && point.x + reach_px < right &&
         point.y + reach_px < bottom;
}

}  // namespace fleetloc
