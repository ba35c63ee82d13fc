#include "deploy/sim/world/route_field.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace fleetloc {
namespace {

constexpr double kSpacing_m = 0.5;
constexpr float kCell_m = 8.0F;
constexpr float kHeadingBase_m = 2.0F;  // over which a noisy route's heading is taken

std::int32_t cell_of(float x) {
  return static_cast<std::int32_t>(std::floor(x / kCell_m));
}

std::uint64_t key(std::int32_t i, std::int32_t k) {
  return static_cast<std::uint64_t>(static_cast<std::uint32_t>(i)) << 32U |
         static_cast<std::uint32_t>(k);
}

Eigen::Vector2f turned(const Eigen::Vector2f& v, float angle) {
  const float c = std::cos(angle);
  const float s = std::sin(angle);
  return {c * v.x() - s * v.y(), s * v.x() + c * v.y()};
}

/// Axes of `a` separate the two.
bool separated(const Footprint& a, const Footprint& b) {
  const Eigen::Vector2f between = turned(b.center - a.center, -a.yaw_rad);
  const Eigen::Vector2f u = turned(Eigen::Vector2f(b.half_size.x(), 0.0F), b.yaw_rad - a.yaw_rad);
  const Eigen::Vector2f v = turned(Eigen::Vector2f(0.0F, b.half_size.y()), b.yaw_rad - a.yaw_rad);
  const Eigen::Vector2f reach = a.half_size + u.cwiseAbs() + v.cwiseAbs();
  return (between.cwiseAbs().array() > reach.array()).any();
}

}  // namespace

float Footprint::distance(const Eigen::Vector2f& p) const {
  const Eigen::Vector2f local = turned(p - center, -yaw_rad);
  return (local.cwiseAbs() - half_size).cwiseMax(0.0F).norm();
}

bool Footprint::overlaps(const Footprint& other) const {
  return !separated(*this, other) && !separated(other, *this);
}

RouteField::RouteField(std::span<const Eigen::Vector3d> route_map) {
  double missing = 0.0;  // from the last point to the next
  for (std::size_t i = 0; i < route_map.size(); ++i) {
    if (!route_map[i].allFinite()) throw std::invalid_argument("route: a position is not finite");
    if (i == 0) {
      points_.emplace_back(route_map[0].cast<float>());
      missing = kSpacing_m;
      continue;
    }
    const Eigen::Vector3d way = route_map[i] - route_map[i - 1];
    const double length = way.head<2>().norm();
    while (missing <= length) {
      points_.emplace_back((route_map[i - 1] + way * (missing / length)).cast<float>());
      missing += kSpacing_m;
    }
    missing -= length;
  }
  if (points_.size() < 2) throw std::invalid_argument("route: it must be at least 0.5 m long");
  for (std::uint32_t i = 0; i < points_.size(); ++i) {
    cells_[key(cell_of(points_[i].x()), cell_of(points_[i].y()))].push_back(i);
  }
}

float RouteField::length_m() const {
  return static_cast<float>(kSpacing_m) * static_cast<float>(points_.size() - 1);
}

Eigen::Vector3f RouteField::position(float arc_m) const {
  const float index = std::clamp(arc_m, 0.0F, length_m()) / static_cast<float>(kSpacing_m);
  const auto i = std::min(static_cast<std::size_t>(index), points_.size() - 2);
  const float share = index - static_cast<float>(i);
  return (1.0F - share) * points_[i] + share * points_[i + 1];
}

float RouteField::heading_rad(float arc_m) const {
  const float arc = std::clamp(arc_m, 0.0F, length_m());
  const Eigen::Vector3f way = position(arc + kHeadingBase_m) - position(arc - kHeadingBase_m);
  return std::atan2(way.y(), way.x());
}

Eigen::Vector3f RouteField::beside(float arc_m, float lateral_m) const {
  const float heading = heading_rad(arc_m);
  const float beyond = arc_m - std::clamp(arc_m, 0.0F, length_m());
  const Eigen::Vector3f along(std::cos(heading), std::sin(heading), 0.0F);
  const Eigen::Vector3f left(-along.y(), along.x(), 0.0F);
  return position(arc_m) + beyond * along + lateral_m * left;
}

template <typename Visit>
void RouteField::visit_near(const Eigen::Vector2f& p, float radius_m, const Visit& visit) const {
  for (std::int32_t i = cell_of(p.x() - radius_m); i <= cell_of(p.x() + radius_m); ++i) {
    for (std::int32_t k = cell_of(p.y() - radius_m); k <= cell_of(p.y() + radius_m); ++k) {
      const auto cell = cells_.find(key(i, k));
      if (cell == cells_.end()) continue;
      for (const std::uint32_t index : cell->second) visit(points_[index]);
    }
  }
}

float RouteField::distance(const Eigen::Vector2f& p, float max_m) const {
  float min_square = max_m * max_m;
  visit_near(p, max_m, [&](const Eigen::Vector3f& point) {
    min_square = std::min(min_square, (point.head<2>() - p).squaredNorm());
  });
  return std::sqrt(min_square);
}

bool RouteField::is_clear(const Footprint& footprint, float clearance_m) const {
  bool clear = true;
  const float margin = 0.25F * static_cast<float>(kSpacing_m);  // between two points
  visit_near(footprint.center,
             footprint.half_size.norm() + clearance_m + margin,
             [&](const Eigen::Vector3f& point) {
               clear = clear && footprint.distance(point.head<2>()) > clearance_m + margin;
             });
  return clear;
}

std::vector<Eigen::Vector3f> RouteField::near(const Eigen::Vector2f& p, float radius_m) const {
  std::vector<Eigen::Vector3f> found;
  visit_near(p, radius_m, [&](const Eigen::Vector3f& point) {
    if ((point.head<2>() - p).norm() <= radius_m) found.push_back(point);
  });
  return found;
}

}  // namespace fleetloc
