#include "robot/tracking/corner_detection.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/features2d.hpp>

namespace fleetloc {
namespace {

constexpr int kFastRadius = 3;       // [px]
constexpr int kScoreRadius = 3;      // [px]
constexpr std::size_t kScored = 20;  // strongest FAST corners of a cell that get a score

struct Cell {
  cv::Rect area;
  int features = 0;
  std::vector<cv::KeyPoint> candidates;  // best last
};

/// Smallest eigenvalue of the gradients' second moments (Shi and Tomasi: Good features to track,
/// 1994), per pixel, central differences.
float shi_tomasi_score(const cv::Mat& image, const cv::Point& center) {
  float xx = 0.0F;
  float xy = 0.0F;
  float yy = 0.0F;
  for (int y = center.y - kScoreRadius; y <= center.y + kScoreRadius; ++y) {
    const auto* row = image.ptr<unsigned char>(y);
    const auto* above = image.ptr<unsigned char>(y - 1);
    const auto* below = image.ptr<unsigned char>(y + 1);
    for (int x = center.x - kScoreRadius; x <= center.x + kScoreRadius; ++x) {
      const auto dx = static_cast<float>(row[x + 1] - row[x - 1]);
      const auto dy = static_cast<float>(below[x] - above[x]);
      xx += dx * dx;
      xy += dx * dy;
      yy += dy * dy;
    }
  }
  const float root = std::sqrt((xx - yy) * (xx - yy) + 4.0F * xy * xy);
  constexpr float kSide = 2 * kScoreRadius + 1;
  return 0.5F * (xx + yy - root) / (4.0F * kSide * kSide);  // differences are of two pixels
}

std::vector<Cell> make_grid(const cv::Size& size, const CornerDetectionConfig& config) {
  const int margin = std::max(config.margin_px, kScoreRadius + 1);
  const int width = std::max(0, size.width - 2 * margin);
  const int height = std::max(0, size.height - 2 * margin);
  std::vector<Cell> cells;
  for (int row = 0; row < config.rows; ++row) {
    for (int column = 0; column < config.columns; ++column) {
      const cv::Point from(margin + width * column / config.columns,
                           margin + height * row / config.rows);
      const cv::Point to(margin + width * (column + 1) / config.columns,
                         margin + height * (row + 1) / config.rows);
      cells.push_back({cv::Rect(from, to), 0, {}});
    }
  }
  return cells;
}

void count_present(std::vector<Cell>& cells, const std::vector<cv::Point2f>& present) {
  for (const auto& point : present) {
    const cv::Point pixel(cvFloor(point.x), cvFloor(point.y));
    const auto cell = std::find_if(
        cells.begin(), cells.end(), [&](const Cell& c) { return c.area.contains(pixel); });
    if (cell != cells.end()) ++cell->features;
  }
}

void find_candidates(Cell& cell, const cv::Mat& image, const CornerDetectionConfig& config) {
  const cv::Rect whole(0, 0, image.cols, image.rows);
  const cv::Rect seen = cv::Rect(cell.area.tl() - cv::Point(kFastRadius, kFastRadius),
                                 cell.area.br() + cv::Point(kFastRadius, kFastRadius)) &
                        whole;
  if (cell.area.empty()) return;
  auto& corners = cell.candidates;
  cv::FAST(image(seen), corners, config.fast_threshold, true);
  const auto weaker = [](const cv::KeyPoint& a, const cv::KeyPoint& b) {
    return a.response < b.response;
  };
  std::stable_sort(corners.begin(), corners.end(), weaker);
  if (corners.size() > kScored) {
    corners.erase(corners.begin(), corners.end() - static_cast<std::ptrdiff_t>(kScored));
  }
  for (auto& corner : corners) {
    corner.pt += cv::Point2f(seen.tl());
    corner.response = shi_tomasi_score(image, cv::Point(corner.pt));
  }
  std::erase_if(corners, [&](const cv::KeyPoint& corner) {
    return corner.response < static_cast<float>(config.min_score);
  });
  std::stable_sort(corners.begin(), corners.end(), weaker);
}

bool is_free(const cv::Point2f& point, const std::vector<cv::Point2f>& taken, double distance) {
  return std::none_of(taken.begin(), taken.end(), [&](const cv::Point2f& other) {
    const cv::Point2f difference = point - other;
    return difference.dot(difference) < distance * distance;
  });
}

/// Takes the cell's best corner that is far enough from all `taken`.
bool take_best(Cell& cell, std::vector<cv::Point2f>& taken, double distance) {
  while (!cell.candidates.empty()) {
    const cv::Point2f point = cell.candidates.back().pt;
    cell.candidates.pop_back();
    if (!is_free(point, taken, distance)) continue;
    taken.push_back(point);
    ++cell.features;
    return true;
  }
  return false;
}

}  // namespace

CornerDetectionConfig read_corner_detection_config(ConfigReader section) {
  CornerDetectionConfig config{.features = section.integer("features", 10, 2000),
                               .refill_below = section.integer("refill_below", 1, 2000),
                               .columns = section.integer("columns", 1, 100),
                               .rows = section.integer("rows", 1, 100),
                               .fast_threshold = section.integer("fast_threshold", 1, 200),
                               .min_score = section.positive("min_score"),
                               .min_distance_px = section.positive("min_distance_px"),
                               .margin_px = section.integer("margin_px", 0, 200)};
  config.refill_below = std::min(config.refill_below, config.features);
  return config;
}

std::vector<cv::Point2f> detect_corners(const cv::Mat& image,
                                        const std::vector<cv::Point2f>& present,
                                        const CornerDetectionConfig& config) {
  if (present.size() >= static_cast<std::size_t>(config.refill_below)) return {};
  auto cells = make_grid(image.size(), config);
  count_present(cells, present);
  const int cell_count = config.columns * config.rows;
  const int max_features = (config.features + cell_count - 1) / cell_count;
  for (auto& cell : cells) {
    if (cell.features < max_features) find_candidates(cell, image, config);
  }
  std::vector<cv::Point2f> taken = present;
  for (int features = 0; features < max_features; ++features) {  // emptiest cells first
    for (auto& cell : cells) {
      if (taken.size() >= static_cast<std::size_t>(config.features)) break;
      if (cell.features == features) take_best(cell, taken, config.min_distance_px);
    }
  }
  return {taken.begin() + static_cast<std::ptrdiff_t>(present.size()), taken.end()};
}

}  // namespace fleetloc
