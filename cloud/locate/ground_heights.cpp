#include "cloud/locate/ground_heights.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <deque>
#include <limits>
#include <utility>

namespace fleetloc {
namespace {

constexpr double kCell_m = 2.0;
constexpr int kReach = 2;  // [cells]; roofs that are narrower are none

constexpr float kNone = std::numeric_limits<float>::infinity();

int cells(double length_m) {
  return std::max(1, static_cast<int>(std::ceil(length_m / kCell_m)));
}

}  // namespace

GroundHeights::GroundHeights(const LaserMap& map, double level_from) {
  Eigen::Vector2f min_map = Eigen::Vector2f::Constant(kNone);
  Eigen::Vector2f max_map = -min_map;
  for (const MapPoint& point : map.points()) {
    min_map = min_map.cwiseMin(point.p_map.head<2>());
    max_map = max_map.cwiseMax(point.p_map.head<2>());
  }
  if (map.size() > 0) {
    min_map_ = min_map.cast<double>();
    width_ = cells(max_map.x() - min_map.x());
    depth_ = cells(max_map.y() - min_map.y());
  }
  heights_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(depth_), kNone);
  for (const MapPoint& point : map.points()) {
    if (std::abs(static_cast<double>(point.normal.z())) <= level_from) continue;
    float& height = heights_[index(point.p_map.x(), point.p_map.y())];
    height = std::min(height, point.p_map.z());
  }
  widen_lowest();
  fill_gaps();
}

GroundHeights::GroundHeights(const Eigen::Vector2d& min_map,
                             int width,
                             int depth,
                             std::vector<float> heights)
    : min_map_(min_map), width_(width), depth_(depth), heights_(std::move(heights)) {
  assert(width > 0 && depth > 0);
  assert(heights_.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(depth));
}

std::size_t GroundHeights::index(double x_m, double y_m) const {
  const auto cell = [](double offset_m, int count) {
    return static_cast<int>(std::clamp(std::floor(offset_m / kCell_m), 0.0, count - 1.0));
  };
  const int x = cell(x_m - min_map_.x(), width_);
  const int y = cell(y_m - min_map_.y(), depth_);
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
         static_cast<std::size_t>(x);
}

double GroundHeights::at(double x_m, double y_m) const {
  return heights_[index(x_m, y_m)];
}

GroundHeights::Range GroundHeights::range(const Eigen::Vector2d& min_map,
                                          const Eigen::Vector2d& max_map) const {
  const double first = at(min_map.x(), min_map.y());
  Range result{first, first};
  const Eigen::Vector2d size = kCell_m * Eigen::Vector2d(width_, depth_);
  const Eigen::Vector2d from = min_map.cwiseMax(min_map_);
  const Eigen::Vector2d to = max_map.cwiseMin(min_map_ + size);
  for (double y = from.y(); y < to.y() + kCell_m; y += kCell_m) {
    for (double x = from.x(); x < to.x() + kCell_m; x += kCell_m) {
      const double height = at(std::min(x, to.x()), std::min(y, to.y()));
      result = {std::min(result.lowest_m, height), std::max(result.highest_m, height)};
    }
  }
  return result;
}

// Along one axis, then the other.
void GroundHeights::widen_lowest() {
  const auto along = [&](int lines, int length, int line_step, int step) {
    std::vector<float> line(static_cast<std::size_t>(length));
    for (int l = 0; l < lines; ++l) {
      const auto cell = [&](int i) -> float& {
        return heights_[static_cast<std::size_t>(l * line_step + i * step)];
      };
      for (int i = 0; i < length; ++i) {
        float lowest = kNone;
        for (int j = std::max(0, i - kReach); j <= std::min(length - 1, i + kReach); ++j) {
          lowest = std::min(lowest, cell(j));
        }
        line[static_cast<std::size_t>(i)] = lowest;
      }
      for (int i = 0; i < length; ++i) cell(i) = line[static_cast<std::size_t>(i)];
    }
  };
  along(depth_, width_, width_, 1);
  along(width_, depth_, 1, width_);
}

void GroundHeights::fill_gaps() {
  std::deque<int> border;
  for (int i = 0; i < width_ * depth_; ++i) {
    if (heights_[static_cast<std::size_t>(i)] != kNone) border.push_back(i);
  }
  if (border.empty()) std::ranges::fill(heights_, 0.0F);
  while (!border.empty()) {
    const int i = border.front();
    border.pop_front();
    const auto fill = [&](bool is_inside, int beside) {
      if (!is_inside || heights_[static_cast<std::size_t>(beside)] != kNone) return;
      heights_[static_cast<std::size_t>(beside)] = heights_[static_cast<std::size_t>(i)];
      border.push_back(beside);
    };
    fill(i % width_ > 0, i - 1);
    fill(i % width_ < width_ - 1, i + 1);
    fill(i >= width_, i - width_);
    fill(i < width_ * (depth_ - 1), i + width_);
  }
}

}  // namespace fleetloc
