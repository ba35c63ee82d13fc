#include "cloud/locate/place_search.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

Eigen::Vector3i floored(const Eigen::Vector3d& p) {
  return p.array().floor().cast<int>();
}

double yaw_of(std::size_t step, std::size_t steps) {
  return 2.0 * std::numbers::pi * static_cast<double>(step) / static_cast<double>(steps);
}

Pose turned_about_z(double yaw_rad, const Eigen::Vector3d& p) {
  return {exp_so3({0.0, 0.0, yaw_rad}), p};
}

}  // namespace

PlaceSearch::PlaceSearch(const MapPyramid& map,
                         const std::vector<SeenLandmark>& landmarks,
                         const SearchRegion& region,
                         const Config& config)
    : map_(map),
      config_(config),
      first_(floored(region.min_map / map.cell_m())),
      last_(floored(region.max_map / map.cell_m())) {
  if (landmarks.empty()) return;
  for (const SeenLandmark& landmark : landmarks) center_ += landmark.p;
  center_ /= static_cast<double>(landmarks.size());
  double radius = 1.0;  // [cells]
  for (const SeenLandmark& landmark : landmarks) {
    radius = std::max(radius, (landmark.p - center_).head<2>().norm() / map.cell_m());
    weights_.push_back(landmark.weight);
    full_score_ += MapPyramid::kFull * landmark.weight;
  }
  cells_.resize(static_cast<std::size_t>(std::ceil(2.0 * std::numbers::pi * radius)));
  for (std::size_t yaw = 0; yaw < cells_.size(); ++yaw) {
    const double angle = yaw_of(yaw, cells_.size());
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    for (const SeenLandmark& landmark : landmarks) {
      const Eigen::Vector3d p = (landmark.p - center_) / map.cell_m();
      cells_[yaw].push_back(floored({c * p.x() - s * p.y(), s * p.x() + c * p.y(), p.z()}));
    }
  }
  add_roots();
}

void PlaceSearch::add_roots() {
  const int level = map_.levels() - 1;
  const int step = 1 << level;
  for (int yaw = 0; yaw < headings(); ++yaw) {
    for (int y = first_.y(); y <= last_.y(); y += step) {
      for (int x = first_.x(); x <= last_.x(); x += step) add(level, yaw, {x, y, first_.z()});
    }
  }
}

void PlaceSearch::add(int level, int yaw, const Eigen::Vector3i& at) {
  const std::vector<Eigen::Vector3i>& cells = cells_[static_cast<std::size_t>(yaw)];
  int bound = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const int x = at.x() + cells[i].x();
    const int y = at.y() + cells[i].y();
    bound += weights_[i] *
             (level == kLeaf ? map_.value(x, y, at.z() + cells[i].z()) : map_.largest(level, x, y));
  }
  evaluations_ += cells.size();
  if (level == kLeaf) best_leaf_ = std::max(best_leaf_, bound);
  if (bound < config_.min_share * best_leaf_) {
    best_dropped_ = std::max(best_dropped_, bound);
    return;
  }
  queue_.push({.bound = bound, .level = level, .yaw = yaw, .at = at});
}

void PlaceSearch::split(const Node& node) {
  if (node.level == 0) {
    for (int z = first_.z(); z <= last_.z(); ++z) {
      add(kLeaf, node.yaw, {node.at.x(), node.at.y(), z});
    }
    return;
  }
  const int level = node.level - 1;
  const int size = 1 << level;
  for (const int y : {node.at.y(), node.at.y() + size}) {
    for (const int x : {node.at.x(), node.at.x() + size}) {
      if (x <= last_.x() && y <= last_.y()) add(level, node.yaw, {x, y, node.at.z()});
    }
  }
}

// Leaves come in the order of their score: the first one of a place is its best.
void PlaceSearch::take(const Node& leaf) {
  const double yaw = yaw_of(static_cast<std::size_t>(leaf.yaw), cells_.size());
  const Eigen::Vector3d center_map = map_.cell_m() * leaf.at.cast<double>();
  const auto is_same = [&](const FoundPlace& place) {
    const Pose there = place.T_map_seen;
    return (there * center_ - center_map).norm() < config_.same_m &&
           log_so3(there.R.conjugate() * exp_so3({0.0, 0.0, yaw})).norm() < config_.same_rad;
  };
  if (std::ranges::any_of(places_, is_same)) return;
  Pose T = turned_about_z(yaw, Eigen::Vector3d::Zero());
  T.p = center_map - T.R * center_;
  places_.push_back({T, score_of(leaf)});
}

bool PlaceSearch::advance(std::size_t evaluations) {
  const std::size_t end = evaluations_ + evaluations;
  while (evaluations_ < end) {
    const bool is_enough = static_cast<int>(places_.size()) >= config_.max_places ||
                           (!queue_.empty() && queue_.top().bound < config_.min_share * best_leaf_);
    if (queue_.empty() || is_enough) return true;
    const Node node = queue_.top();
    queue_.pop();
    if (node.is_leaf()) {
      ++evaluations_;  // there may be many of one place
      take(node);
    } else {
      split(node);
    }
  }
  return false;
}

double PlaceSearch::score_of(const Node& node) const {
  return static_cast<double>(node.bound) / full_score_;
}

double PlaceSearch::max_score_of_rest() const {
  if (full_score_ == 0) return 0.0;
  const int queued = queue_.empty() ? 0 : queue_.top().bound;
  return static_cast<double>(std::max(queued, best_dropped_)) / full_score_;
}

}  // namespace fleetloc
