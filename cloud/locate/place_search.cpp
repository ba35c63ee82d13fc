#include "cloud/locate/place_search.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

double yaw_of(std::size_t step, std::size_t steps) {
  return 2.0 * std::numbers::pi * static_cast<double>(step) / static_cast<double>(steps);
}

Eigen::Vector3d mean_of(const std::vector<SeenLandmark>& landmarks) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const SeenLandmark& landmark : landmarks) mean += landmark.p;
  return mean / static_cast<double>(landmarks.size());
}

/// So many that none moves a landmark, which is turned about the mean, by more than a cell.
std::size_t headings_for(const std::vector<SeenLandmark>& landmarks, double cell_m) {
  const Eigen::Vector3d mean = mean_of(landmarks);
  double radius_cells = 1.0;
  for (const SeenLandmark& landmark : landmarks) {
    radius_cells = std::max(radius_cells, (landmark.p - mean).head<2>().norm() / cell_m);
  }
  return static_cast<std::size_t>(std::ceil(2.0 * std::numbers::pi * radius_cells));
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
      is_possible_(region.is_possible),
      first_(floored(region.min_map / map.cell_m())),
      last_(floored(region.max_map / map.cell_m())) {
  if (landmarks.empty()) return;
  center_ = mean_of(landmarks);
  for (const SeenLandmark& landmark : landmarks) {
    weights_.push_back(landmark.weight);
    full_score_ += MapPyramid::kFull * landmark.weight;
  }
  turn(landmarks);
  const bool is_height_known = last_.z() - first_.z() <= 2;
  windows_.resize(static_cast<std::size_t>(map.levels()));
  for (const Turned& landmark : turned_.front().front()) {
    const int slab =
        is_height_known ? map.slab_of(first_.z() + 1 + landmark.cell.z()) : map.any_height();
    for (int level = 0; level < map.levels(); ++level) {
      windows_[static_cast<std::size_t>(level)].push_back(&map.windows(level, slab));
    }
  }
}

// At each heading, and in blocks of two, four and so on.
void PlaceSearch::turn(const std::vector<SeenLandmark>& landmarks) {
  std::vector<Landmarks> headings(headings_for(landmarks, map_.cell_m()));
  for (std::size_t yaw = 0; yaw < headings.size(); ++yaw) {
    const double angle = yaw_of(yaw, headings.size());
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    for (const SeenLandmark& landmark : landmarks) {
      const Eigen::Vector3d p = (landmark.p - center_) / map_.cell_m();
      headings[yaw].push_back(
          {.cell = floored({c * p.x() - s * p.y(), s * p.x() + c * p.y(), p.z()})});
    }
  }
  turned_.push_back(std::move(headings));
  for (int level = 1; level < map_.levels(); ++level) {
    const std::vector<Landmarks>& halves = turned_.back();
    std::vector<Landmarks> blocks;
    for (std::size_t half = 0; half < halves.size(); half += 2) {
      blocks.push_back(joined(halves[half], halves[std::min(half + 1, halves.size() - 1)]));
    }
    turned_.push_back(std::move(blocks));
  }
}

PlaceSearch::Landmarks PlaceSearch::joined(const Landmarks& block, const Landmarks& next) {
  Landmarks result = block;
  for (std::size_t i = 0; i < result.size(); ++i) {
    const Eigen::Vector2i a = block[i].cell.head<2>();
    const Eigen::Vector2i b = next[i].cell.head<2>();
    const Eigen::Vector2i end = (a + block[i].extent).cwiseMax(b + next[i].extent);
    result[i].cell.head<2>() = a.cwiseMin(b);
    result[i].extent = end - result[i].cell.head<2>();
  }
  return result;
}

const PlaceSearch::Landmarks& PlaceSearch::block(int level, int yaw) const {
  return turned_[static_cast<std::size_t>(std::max(level, 0))][static_cast<std::size_t>(yaw)];
}

void PlaceSearch::add_roots() {
  rest_.assign(weights_.size(), 0);
  for (std::size_t i = rest_.size(); i-- > 0;) {
    rest_[i] = MapPyramid::kFull * weights_[i] + (i + 1 < rest_.size() ? rest_[i + 1] : 0);
  }
  const int level = map_.levels() - 1;
  const int step = 1 << level;
  for (int yaw = 0; yaw < static_cast<int>(turned_.back().size()); ++yaw) {
    for (int y = first_.y(); y <= last_.y(); y += step) {
      for (int x = first_.x(); x <= last_.x(); x += step) add(level, yaw, {x, y, first_.z()});
    }
  }
}

// The largest over all positions and headings of the node. A block of 2^level headings moves no
// landmark by more cells than that, so that two windows an axis leave no gap.
int PlaceSearch::value(int level,
                       std::size_t landmark,
                       const Turned& turned,
                       const Eigen::Vector3i& at) const {
  const Eigen::Vector3i cell = at + turned.cell;
  if (level == kLeaf) return map_.value(cell.x(), cell.y(), cell.z());
  const MapPyramid::Windows& windows = *windows_[static_cast<std::size_t>(level)][landmark];
  return windows.largest(cell.x(), cell.y(), turned.extent.x(), turned.extent.y());
}

// In no part of the node has a landmark a larger value than in the node.
void PlaceSearch::note_rest(const Node& node) {
  const Landmarks& landmarks = block(node.level, node.yaw);
  int rest = 0;
  for (std::size_t i = landmarks.size(); i-- > 0;) {
    rest += weights_[i] * value(node.level, i, landmarks[i], node.at);
    rest_[i] = rest;
  }
  evaluations_ += landmarks.size();
}

void PlaceSearch::add(int level, int yaw, const Eigen::Vector3i& at) {
  const Landmarks& landmarks = block(level, yaw);
  const int enough = static_cast<int>(std::ceil(config_.min_share * best_leaf_));
  int bound = 0;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (bound + rest_[i] < enough) {  // whatever the others have
      evaluations_ += i;
      best_dropped_ = std::max(best_dropped_, bound + rest_[i]);
      return;
    }
    bound += weights_[i] * value(level, i, landmarks[i], at);
  }
  evaluations_ += landmarks.size();
  if (level == kLeaf) {
    if (is_possible_ && !is_possible_(pose_of(yaw, at))) return;
    best_leaf_ = std::max(best_leaf_, bound);
  }
  if (bound < config_.min_share * best_leaf_) {
    best_dropped_ = std::max(best_dropped_, bound);
    return;
  }
  queue_.push({.bound = bound, .level = level, .yaw = yaw, .at = at});
}

void PlaceSearch::split(const Node& node) {
  note_rest(node);
  if (node.level > 0) return split_level(node);
  for (int z = first_.z(); z <= last_.z(); ++z) {
    add(kLeaf, node.yaw, {node.at.x(), node.at.y(), z});
  }
}

void PlaceSearch::split_level(const Node& node) {
  const int level = node.level - 1;
  const int size = 1 << level;
  const auto& blocks = turned_[static_cast<std::size_t>(level)];
  for (const int yaw : {2 * node.yaw, 2 * node.yaw + 1}) {
    if (yaw >= static_cast<int>(blocks.size())) continue;
    for (const int y : {node.at.y(), node.at.y() + size}) {
      for (const int x : {node.at.x(), node.at.x() + size}) {
        if (x <= last_.x() && y <= last_.y()) add(level, yaw, {x, y, node.at.z()});
      }
    }
  }
}

// Leaves come in the order of their score: the first one of a place is its best.
void PlaceSearch::take(const Node& leaf) {
  const Pose T = pose_of(leaf.yaw, leaf.at);
  const auto is_same = [&](const FoundPlace& place) {
    const Pose& there = place.T_map_seen;
    return (there * center_ - T * center_).norm() < config_.same_m &&
           log_so3(there.R.conjugate() * T.R).norm() < config_.same_rad;
  };
  if (std::ranges::none_of(places_, is_same)) places_.push_back({T, score_of(leaf)});
}

Pose PlaceSearch::pose_of(int yaw, const Eigen::Vector3i& at) const {
  const double angle = yaw_of(static_cast<std::size_t>(yaw), turned_.front().size());
  Pose T = turned_about_z(angle, Eigen::Vector3d::Zero());
  T.p = map_.cell_m() * at.cast<double>() - T.R * center_;
  return T;
}

double PlaceSearch::candidates(const MapPyramid& map,
                               const std::vector<SeenLandmark>& landmarks,
                               const SearchRegion& region) {
  if (landmarks.empty()) return 0.0;
  const Eigen::Vector3i first = floored(region.min_map / map.cell_m());
  const Eigen::Vector3i last = floored(region.max_map / map.cell_m());
  const Eigen::Vector3i size = last - first + Eigen::Vector3i::Ones();
  return size.cwiseMax(0).cast<double>().prod() *
         static_cast<double>(headings_for(landmarks, map.cell_m()));
}

bool PlaceSearch::advance(std::size_t evaluations) {
  if (turned_.empty()) return true;
  const std::size_t end = evaluations_ + evaluations;
  if (!std::exchange(has_begun_, true)) add_roots();
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
