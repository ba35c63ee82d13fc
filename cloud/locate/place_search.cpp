#include "cloud/locate/place_search.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

constexpr int kSweeps = 20;  // from a score of 1 to 0

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
                         std::vector<SeenLandmark> landmarks,
                         const SearchRegion& region,
                         const Config& config)
    : map_(map),
      config_(config),
      is_possible_(region.is_possible),
      first_(floored(region.min_map / map.cell_m())),
      last_(floored(region.max_map / map.cell_m())) {
  if (landmarks.empty()) return;
  center_ = mean_of(landmarks);
  // The heaviest first: they lower bounds the most.
  std::ranges::stable_sort(landmarks, std::greater<>(), &SeenLandmark::weight);
  for (const SeenLandmark& landmark : landmarks) {
    weights_.push_back(landmark.weight);
    full_score_ += MapPyramid::kFull * landmark.weight;
    heights_.push_back(floored((landmark.p - center_) / map.cell_m()).z());
  }
  turn(landmarks);
  sweep_from_ = full_score_ + 1;
  const Eigen::Vector3i size = last_ - first_ + Eigen::Vector3i::Ones();
  const int edge = 1 << (map.levels() - 1);
  roots_ = (size.cwiseMax(0).head<2>().array() + (edge - 1)) / edge;
  waiting_.resize(static_cast<std::size_t>(roots_.prod()) * turned_.back().size());
  const bool is_height_known = last_.z() - first_.z() <= 2;
  windows_.resize(static_cast<std::size_t>(map.levels()));
  for (const int height : heights_) {
    const int slab = is_height_known ? map.slab_of(first_.z() + 1 + height) : map.any_height();
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
      const Eigen::Vector3i cell = floored({c * p.x() - s * p.y(), s * p.x() + c * p.y(), p.z()});
      headings[yaw].push_back({.x = cell.x(), .y = cell.y()});
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
  Landmarks result(block.size());
  for (std::size_t i = 0; i < result.size(); ++i) {
    const Turned& a = block[i];
    const Turned& b = next[i];
    const int x = std::min(a.x, b.x);
    const int y = std::min(a.y, b.y);
    result[i] = {.x = x,
                 .y = y,
                 .wide = static_cast<std::uint16_t>(std::max(a.x + a.wide, b.x + b.wide) - x),
                 .deep = static_cast<std::uint16_t>(std::max(a.y + a.deep, b.y + b.deep) - y)};
  }
  return result;
}

const PlaceSearch::Landmarks& PlaceSearch::block(int level, int yaw) const {
  return turned_[static_cast<std::size_t>(std::max(level, 0))][static_cast<std::size_t>(yaw)];
}

// The largest over all positions and headings of the node. A block of 2^level headings moves no
// landmark by more cells than that, so that two windows an axis leave no gap.
int PlaceSearch::value(const Node& node, std::size_t landmark, const Turned& turned) const {
  const int x = node.at.x() + turned.x;
  const int y = node.at.y() + turned.y;
  if (node.is_leaf()) return map_.value(x, y, node.at.z() + heights_[landmark]);
  const MapPyramid::Windows& windows = *windows_[static_cast<std::size_t>(node.level)][landmark];
  return windows.largest(x, y, turned.wide, turned.deep);
}

void PlaceSearch::split(const Node& node) {
  parts_.clear();
  if (node.level == 0) {
    for (int z = first_.z(); z <= last_.z(); ++z) {
      add_part(node.bound, kLeaf, node.yaw, {node.at.x(), node.at.y(), z});
    }
  } else {
    add_quarters(node);
  }
  const Landmarks& landmarks = block(node.level, node.yaw);
  bound_parts([&](std::size_t i) { return value(node, i, landmarks[i]); });
}

// Of both halves of the headings.
void PlaceSearch::add_quarters(const Node& node) {
  const int level = node.level - 1;
  const int size = 1 << level;
  const int yaws = static_cast<int>(turned_[static_cast<std::size_t>(level)].size());
  for (int yaw = 2 * node.yaw; yaw < std::min(2 * node.yaw + 2, yaws); ++yaw) {
    for (const int y : {node.at.y(), node.at.y() + size}) {
      for (const int x : {node.at.x(), node.at.x() + size}) {
        if (x > last_.x() || y > last_.y()) continue;
        add_part(node.bound, level, yaw, {x, y, node.at.z()});
      }
    }
  }
}

void PlaceSearch::add_part(int bound_of_whole, int level, int yaw, const Eigen::Vector3i& at) {
  parts_.push_back({.node = {.bound = bound_of_whole, .level = level, .yaw = yaw, .at = at},
                    .landmarks = block(level, yaw).data()});
}

// From the bound of what they are parts of: no landmark has a larger value in a part, so that each
// can only lower it. All parts look at one landmark before the next: they look at the same corner
// of the map.
template <typename ValueInWhole>
void PlaceSearch::bound_parts(const ValueInWhole& value_in_whole) {
  const int least = enough();
  for (std::size_t i = 0; i < weights_.size() && !parts_.empty(); ++i) {
    const int whole = value_in_whole(i);
    evaluations_ += 1 + parts_.size();
    for (Part& part : parts_) {
      part.node.bound -= weights_[i] * (whole - value(part.node, i, part.landmarks[i]));
    }
    std::erase_if(parts_, [&](const Part& part) { return is_dropped(part.node, least); });
  }
  for (const Part& part : parts_) add(part.node);
}

bool PlaceSearch::is_dropped(const Node& node, int least) {
  if (node.bound >= least) return false;
  best_dropped_ = std::max(best_dropped_, node.bound);
  return true;
}

void PlaceSearch::add(const Node& node) {
  if (!node.is_leaf()) {
    (node.bound >= sweep_from_ ? open_ : waiting_[root_]).push_back(node);
  } else if (!is_possible_ || is_possible_(pose_of(node.yaw, node.at))) {
    best_leaf_ = std::max(best_leaf_, node.bound);
    leaves_.push(node);
  }
}

int PlaceSearch::enough() const {
  return std::max(1, static_cast<int>(std::ceil(config_.min_share * best_leaf_)));
}

// Until what is left has too little.
bool PlaceSearch::begin_sweep() {
  if (sweep_from_ <= enough()) return false;
  sweep_from_ = std::max(enough(), sweep_from_ - full_score_ / kSweeps - 1);
  next_root_ = 0;
  return true;
}

// The first time it is only bounded.
void PlaceSearch::open_next_root() {
  ++evaluations_;  // most have nothing
  root_ = next_root_++;
  if (sweep_from_ > full_score_) return bound_root();
  std::vector<Node>& waiting = waiting_[root_];
  const auto is_later = [this](const Node& node) { return node.bound < sweep_from_; };
  const auto begin = std::ranges::partition(waiting, is_later).begin();
  open_.assign(begin, waiting.end());
  waiting.erase(begin, waiting.end());
}

void PlaceSearch::bound_root() {
  const auto headings = turned_.back().size();
  const auto position = static_cast<int>(root_ / headings);
  const int level = map_.levels() - 1;
  const int edge = 1 << level;
  parts_.clear();
  add_part(full_score_,
           level,
           static_cast<int>(root_ % headings),
           {first_.x() + edge * (position % roots_.x()),
            first_.y() + edge * (position / roots_.x()),
            first_.z()});
  bound_parts([](std::size_t) { return MapPyramid::kFull; });
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
  if (waiting_.empty()) return true;
  const std::size_t end = evaluations_ + evaluations;
  while (evaluations_ < end) {
    if (static_cast<int>(places_.size()) >= config_.max_places) return true;
    if (!open_.empty()) {
      const Node node = open_.back();
      open_.pop_back();
      split(node);
    } else if (next_root_ < waiting_.size()) {
      open_next_root();
    } else if (!leaves_.empty() && leaves_.top().bound >= std::max(sweep_from_, enough())) {
      ++evaluations_;  // there may be many of one place
      take(leaves_.top());
      leaves_.pop();
    } else if (!begin_sweep()) {
      return true;
    }
  }
  return false;
}

double PlaceSearch::score_of(const Node& node) const {
  return static_cast<double>(node.bound) / full_score_;
}

double PlaceSearch::max_score_of_rest() const {
  if (waiting_.empty()) return 0.0;
  const bool are_all_bounded = sweep_from_ <= full_score_ || next_root_ == waiting_.size();
  if (!are_all_bounded) return 1.0;
  int most = std::max(best_dropped_, leaves_.empty() ? 0 : leaves_.top().bound);
  for (const Node& node : open_) most = std::max(most, node.bound);
  for (const std::vector<Node>& nodes : waiting_) {
    for (const Node& node : nodes) most = std::max(most, node.bound);
  }
  return static_cast<double>(most) / full_score_;
}

}  // namespace fleetloc
