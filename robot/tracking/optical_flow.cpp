#include "robot/tracking/optical_flow.hpp"

#include <algorithm>

#include <opencv2/video/tracking.hpp>

namespace fleetloc {
namespace {

constexpr double kMinTexture = 1e-3;  // smallest eigenvalue of a window's gradients, as OpenCV's

std::vector<unsigned char> lucas_kanade(const ImagePyramid& from,
                                        const ImagePyramid& to,
                                        const std::vector<cv::Point2f>& points,
                                        std::vector<cv::Point2f>& moved,
                                        const OpticalFlowConfig& config) {
  std::vector<unsigned char> found;
  const cv::TermCriteria criteria(
      cv::TermCriteria::COUNT | cv::TermCriteria::EPS, config.iterations, config.converged_px);
  cv::calcOpticalFlowPyrLK(from.images_and_gradients(),
                           to.images_and_gradients(),
                           points,
                           moved,
                           found,
                           cv::noArray(),
                           cv::Size(config.window_px, config.window_px),
                           config.levels,
                           criteria,
                           cv::OPTFLOW_USE_INITIAL_FLOW,
                           kMinTexture);
  return found;
}

bool is_in_image(const cv::Point2f& point, const cv::Mat& image) {
  return point.x >= 0.0F && point.y >= 0.0F && point.x <= static_cast<float>(image.cols - 1) &&
         point.y <= static_cast<float>(image.rows - 1);
}

std::vector<std::optional<cv::Point2f>> follow_once(const ImagePyramid& from,
                                                    const ImagePyramid& to,
                                                    const std::vector<cv::Point2f>& points,
                                                    const std::vector<cv::Point2f>& start,
                                                    const OpticalFlowConfig& config) {
  std::vector<std::optional<cv::Point2f>> result(points.size());
  if (points.empty()) return result;
  std::vector<cv::Point2f> moved = start;
  const auto found = lucas_kanade(from, to, points, moved, config);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (found[i] != 0 && is_in_image(moved[i], to.image())) result[i] = moved[i];
  }
  return result;
}

}  // namespace

OpticalFlowConfig read_optical_flow_config(ConfigReader section) {
  return {.window_px = 2 * section.integer("window_half_px", 2, 20) + 1,
          .levels = section.integer("levels", 0, 6),
          .iterations = section.integer("iterations", 1, 100),
          .converged_px = section.positive("converged_px"),
          .round_trip_px = section.positive("round_trip_px")};
}

ImagePyramid::ImagePyramid(const cv::Mat& image, const OpticalFlowConfig& config) {
  levels_ = cv::buildOpticalFlowPyramid(
      image, images_and_gradients_, cv::Size(config.window_px, config.window_px), config.levels);
}

const cv::Mat& ImagePyramid::image(int level) const {
  return images_and_gradients_[2 * static_cast<std::size_t>(level)];
}

std::vector<std::optional<cv::Point2f>> track_points(const ImagePyramid& from,
                                                     const ImagePyramid& to,
                                                     const std::vector<cv::Point2f>& points,
                                                     const std::vector<cv::Point2f>& start,
                                                     const OpticalFlowConfig& config) {
  auto result = follow_once(from, to, points, start, config);
  std::vector<std::size_t> indices;
  std::vector<cv::Point2f> moved;
  std::vector<cv::Point2f> origins;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!result[i]) continue;
    indices.push_back(i);
    moved.push_back(*result[i]);
    origins.push_back(points[i]);
  }
  OpticalFlowConfig way_back = config;
  way_back.levels = 0;
  const auto back = follow_once(to, from, moved, origins, way_back);
  for (std::size_t k = 0; k < indices.size(); ++k) {
    const bool same = back[k] && cv::norm(*back[k] - origins[k]) <= config.round_trip_px;
    if (!same) result[indices[k]].reset();
  }
  return result;
}

}  // namespace fleetloc
