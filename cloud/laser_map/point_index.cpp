#include "cloud/laser_map/point_index.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <utility>

#include <nanoflann.hpp>

namespace fleetloc {
namespace {

/// What nanoflann asks of a point set, under the names that it prescribes.
struct PointSet {
  [[nodiscard]] std::size_t kdtree_get_point_count() const { return points.size(); }
  [[nodiscard]] double kdtree_get_pt(std::size_t index, std::size_t axis) const {
    return static_cast<double>(points[index].p_map[static_cast<Eigen::Index>(axis)]);
  }
  template <typename Box>
  bool kdtree_get_bbox(Box& /*box*/) const {
    return false;
  }

  std::span<const MapPoint> points;
};

using KdTree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, PointSet>,
                                                   PointSet,
                                                   3,
                                                   std::uint32_t>;

constexpr std::size_t kLeafSize = 16;

/// Least number above: nanoflann offers only points nearer than the worst one wanted, but points
/// at the same distance have to be compared by index.
double above(double squared_distance) {
  return std::nextafter(squared_distance, std::numeric_limits<double>::infinity());
}

/// Result set of nanoflann that breaks ties by index.
class NearestPoint {
 public:
  using DistanceType = double;

  explicit NearestPoint(double radius_m) : worst_(above(radius_m * radius_m)) {}

  bool addPoint(double squared_distance, std::uint32_t index) {
    const bool better = !best || squared_distance < best->squared_distance ||
                        (squared_distance == best->squared_distance && index < best->index);
    if (better) {
      best = {.index = index, .squared_distance = squared_distance};
      worst_ = above(squared_distance);
    }
    return true;
  }
  [[nodiscard]] double worstDist() const { return worst_; }
  [[nodiscard]] bool full() const { return best.has_value(); }
  [[nodiscard]] std::size_t size() const { return best ? 1 : 0; }

  std::optional<LaserMap::Neighbour> best;

 private:
  double worst_;
};

/// Result set of nanoflann: the nearest point, ties broken by index, and the next distance.
class NearestTwo {
 public:
  using DistanceType = double;

  explicit NearestTwo(double radius_m) : next(radius_m * radius_m), radius_(next) {}

  bool addPoint(double squared_distance, std::uint32_t index) {
    if (squared_distance > radius_) return true;
    if (!best) {
      best = {.index = index, .squared_distance = squared_distance};
      return true;
    }
    const bool better = squared_distance < best->squared_distance ||
                        (squared_distance == best->squared_distance && index < best->index);
    next = std::min(next, better ? best->squared_distance : squared_distance);
    if (better) best = {.index = index, .squared_distance = squared_distance};
    return true;
  }
  [[nodiscard]] double worstDist() const { return above(next); }
  [[nodiscard]] bool full() const { return best.has_value(); }
  [[nodiscard]] std::size_t size() const { return best ? 1 : 0; }

  std::optional<LaserMap::Neighbour> best;
  double next;  // squared distance of the second nearest, at most that of the radius

 private:
  double radius_;  // squared
};

/// Result set of nanoflann that collects all points within a radius.
class PointsWithin {
 public:
  using DistanceType = double;

  explicit PointsWithin(double radius_m) : worst_(above(radius_m * radius_m)) {}

  bool addPoint(double /*squared_distance*/, std::uint32_t index) {
    indices.push_back(index);
    return true;
  }
  [[nodiscard]] double worstDist() const { return worst_; }
  [[nodiscard]] static bool full() { return true; }
  [[nodiscard]] std::size_t size() const { return indices.size(); }

  std::vector<std::size_t> indices;

 private:
  double worst_;
};

}  // namespace

struct PointIndex::Tree {
  explicit Tree(std::span<const MapPoint> points)
      : set{points}, index(3, set, nanoflann::KDTreeSingleIndexAdaptorParams(kLeafSize)) {}

  PointSet set;
  KdTree index;
};

PointIndex::PointIndex(std::span<const MapPoint> points) {
  if (points.size() > std::numeric_limits<std::uint32_t>::max()) {
    throw std::length_error("a laser map holds at most 2^32 - 1 points");
  }
  tree_ = std::make_unique<const Tree>(points);
}

PointIndex::~PointIndex() = default;

std::optional<LaserMap::Neighbour> PointIndex::nearest(const Eigen::Vector3d& p_map,
                                                       double radius_m) const {
  if (!p_map.allFinite()) return std::nullopt;
  NearestPoint result(radius_m);
  tree_->index.findNeighbors(result, p_map.data(), nanoflann::SearchParams());
  return result.best;
}

LaserMap::Surroundings PointIndex::surroundings(const Eigen::Vector3d& p_map,
                                                double radius_m) const {
  if (!p_map.allFinite()) return {};
  NearestTwo result(radius_m);
  tree_->index.findNeighbors(result, p_map.data(), nanoflann::SearchParams());
  return {.nearest = result.best, .clear_m = std::sqrt(result.next)};
}

std::vector<std::size_t> PointIndex::within(const Eigen::Vector3d& p_map, double radius_m) const {
  if (!p_map.allFinite()) return {};
  PointsWithin result(radius_m);
  tree_->index.findNeighbors(result, p_map.data(), nanoflann::SearchParams());
  std::ranges::sort(result.indices);
  return std::move(result.indices);
}

}  // namespace fleetloc
