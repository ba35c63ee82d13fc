#include "robot/tracking/stereo_matching.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace fleetloc {
namespace {

constexpr int kSearchLevel = 2;   // of the pyramid
constexpr int kSearchRadius = 3;  // of the patch, at that level [px]
constexpr int kSide = 2 * kSearchRadius + 1;
using Patch = std::array<float, static_cast<std::size_t>(kSide) * kSide>;

/// The surroundings of a pixel, of zero mean and unit norm; nothing at the border and without
/// texture. `pixel` is of level 0, nearest pixels are taken.
std::optional<Patch> normalized_patch(const cv::Mat& image, const cv::Point2f& pixel, int level) {
  const float scale = 1.0F / static_cast<float>(1 << level);
  const int column = cvRound(pixel.x * scale) - kSearchRadius;
  const int row = cvRound(pixel.y * scale) - kSearchRadius;
  if (column < 0 || row < 0 || column + kSide > image.cols || row + kSide > image.rows) {
    return std::nullopt;
  }
  Patch patch;
  float* value = patch.data();
  for (int y = row; y < row + kSide; ++y) {
    const auto* line = image.ptr<unsigned char>(y) + column;
    value = std::copy(line, line + kSide, value);
  }
  float sum = 0.0F;
  for (const float v : patch) sum += v;
  const float mean = sum / static_cast<float>(patch.size());
  float energy = 0.0F;
  for (float& v : patch) {
    v -= mean;
    energy += v * v;
  }
  if (energy < static_cast<float>(patch.size())) return std::nullopt;
  const float inverse_norm = 1.0F / std::sqrt(energy);
  for (float& v : patch) v *= inverse_norm;
  return patch;
}

/// The nearest pixel around which there is a whole patch; at the image's border not `pixel` itself.
cv::Point2f to_patch_center(const cv::Mat& image, const cv::Point2f& pixel, int level) {
  const auto scale = static_cast<float>(1 << level);
  const auto clamped = [scale](float value, int size) {
    const float last = static_cast<float>(std::max(size - 1 - kSearchRadius, kSearchRadius));
    return std::clamp(value, scale * kSearchRadius, scale * last);
  };
  return {clamped(pixel.x, image.cols), clamped(pixel.y, image.rows)};
}

}  // namespace

StereoMatchingConfig read_stereo_matching_config(ConfigReader section) {
  return {.levels = section.integer("levels", 0, 6),
          .round_trip_px = section.positive("round_trip_px"),
          .row_error_px = section.positive("row_error_px"),
          .min_disparity_px = section.positive("min_disparity_px"),
          .nearest_m = section.positive("nearest_m"),
          .min_correlation = section.positive("min_correlation"),
          .min_likeness = section.number("min_likeness", 0.0, 1.0),
          .slant_sigma = section.positive("slant_sigma")};
}

StereoMatcher::StereoMatcher(const RectifiedStereo& stereo,
                             RectifiedCamera right_camera,
                             const OpticalFlowConfig& flow,
                             const SlantedPatchConfig& slanted,
                             const StereoMatchingConfig& config)
    : right_camera_(std::move(right_camera)),
      flow_(flow),
      slanted_(slanted),
      config_(config),
      max_disparity_px_(stereo.focal_px * stereo.baseline_m / config.nearest_m),
      focal_px_(stereo.focal_px) {
  flow_.levels = config.levels;
  flow_.round_trip_px = config.round_trip_px;
}

double StereoMatcher::search(const ImagePyramid& left,
                             const ImagePyramid& right,
                             const StereoQuery& query) const {
  const int level = std::min({kSearchLevel, left.levels(), right.levels()});
  const cv::Point2f inwards = to_patch_center(left.image(level), query.left, level) - query.left;
  const auto wanted = normalized_patch(left.image(level), query.left + inwards, level);
  if (!wanted) return 0.0;
  const double step_px = 1 << level;
  double best_disparity = 0.0;
  auto best_correlation = static_cast<float>(config_.min_correlation);
  const int steps = static_cast<int>(max_disparity_px_ / step_px);
  for (int step = 0; step < steps; ++step) {
    const double disparity = (step + 0.5) * step_px;
    const auto pixel = right_camera_.distort(query.rectified - Eigen::Vector2d(disparity, 0.0));
    if (!pixel) continue;
    const auto patch = normalized_patch(right.image(level), *pixel + inwards, level);
    if (!patch) continue;
    float correlation = 0.0F;
    for (std::size_t i = 0; i < patch->size(); ++i) correlation += (*patch)[i] * (*wanted)[i];
    if (correlation <= best_correlation) continue;
    best_correlation = correlation;
    best_disparity = disparity;
  }
  return best_disparity;
}

std::optional<cv::Point2f> StereoMatcher::refined(const ImagePyramid& left,
                                                  const ImagePyramid& right,
                                                  const StereoQuery& query,
                                                  const cv::Point2f& match) const {
  const auto rectified = right_camera_.rectify(match);
  if (!rectified) return std::nullopt;
  const auto further = right_camera_.distort(*rectified + Eigen::Vector2d::UnitX());
  if (!further) return std::nullopt;
  const double disparity = query.rectified.x() - rectified->x();
  if (disparity < config_.min_disparity_px) return std::nullopt;
  const Eigen::Vector2f along =
      Eigen::Vector2f(further->x - match.x, further->y - match.y).normalized();
  // On a plane through a point the disparity changes by its share of the focal length, times the
  // tangent of the slant, per pixel.
  const SearchLine row{.start = match,
                       .direction = along,
                       .slope_sigma = config_.slant_sigma * disparity / focal_px_};
  const auto found = match_slanted(left.image(), right.image(), query.left, row, slanted_);
  if (!found) return std::nullopt;
  const float likeness =
      correlation(left.image(), right.image(), query.left, along, *found, slanted_.radius_px);
  if (likeness < static_cast<float>(config_.min_likeness)) return std::nullopt;
  return found->pixel;
}

std::vector<StereoMatch> StereoMatcher::match(const ImagePyramid& left,
                                              const ImagePyramid& right,
                                              const std::vector<StereoQuery>& queries) const {
  std::vector<StereoMatch> matches(queries.size());
  std::vector<std::size_t> indices;
  std::vector<cv::Point2f> points;
  std::vector<cv::Point2f> starts;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const StereoQuery& query = queries[i];
    const double disparity = query.disparity > 0.0 ? query.disparity : search(left, right, query);
    if (disparity <= 0.0) continue;
    const auto start = right_camera_.distort(query.rectified - Eigen::Vector2d(disparity, 0.0));
    if (!start) continue;
    indices.push_back(i);
    points.push_back(query.left);
    starts.push_back(*start);
  }
  const auto found = track_points(left, right, points, starts, flow_);
  for (std::size_t k = 0; k < indices.size(); ++k) {
    if (!found[k]) continue;
    const auto pixel = refined(left, right, queries[indices[k]], *found[k]);
    if (!pixel) continue;
    const auto rectified = right_camera_.rectify(*pixel);
    if (!rectified) continue;
    const Eigen::Vector2d difference = queries[indices[k]].rectified - *rectified;
    const bool plausible = std::abs(difference.y()) <= config_.row_error_px &&
                           difference.x() >= config_.min_disparity_px &&
                           difference.x() <= max_disparity_px_;
    if (plausible) matches[indices[k]] = {difference.x(), -difference.y()};
  }
  return matches;
}

}  // namespace fleetloc
