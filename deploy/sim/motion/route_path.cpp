#include "deploy/sim/motion/route_path.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace fleetloc {
namespace {

constexpr double kStep = 0.05;  // [m]

/// Direction of a leg seen from above.
Eigen::Vector2d heading(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  return (to - from).head<2>().normalized();
}

void add_straight(const Eigen::Vector3d& to, std::vector<Eigen::Vector3d>& points) {
  const Eigen::Vector3d from = points.back();
  const int steps = static_cast<int>(std::ceil((to - from).head<2>().norm() / kStep));
  for (int i = 1; i <= steps; ++i) points.emplace_back(from + (to - from) * i / steps);
}

/// From the incoming leg to the outgoing one around `corner`; heights go from leg to leg linearly.
void add_corner(const Eigen::Vector3d& before,
                const Eigen::Vector3d& corner,
                const Eigen::Vector3d& after,
                double radius_m,
                std::vector<Eigen::Vector3d>& points) {
  constexpr double kStraight = 1e-3;  // [rad]
  const Eigen::Vector2d in = heading(before, corner);
  const Eigen::Vector2d out = heading(corner, after);
  const double turn = std::atan2(in.x() * out.y() - in.y() * out.x(), in.dot(out));
  const double in_m = (corner - before).head<2>().norm();
  const double out_m = (after - corner).head<2>().norm();
  // An arc begins at most at the middle of a leg; a turn on the spot becomes a narrow one.
  const double tangent = std::tan(0.5 * std::min(std::abs(turn), 0.99 * std::numbers::pi));
  const double cut_m = std::min({radius_m * tangent, 0.5 * in_m, 0.5 * out_m});
  if (std::abs(turn) < kStraight || cut_m < kStep) {
    add_straight(corner, points);
    return;
  }
  const double radius = cut_m / tangent;
  const Eigen::Vector3d begin = corner + (before - corner) * (cut_m / in_m);
  const Eigen::Vector3d end = corner + (after - corner) * (cut_m / out_m);
  add_straight(begin, points);
  const double side = turn > 0.0 ? 1.0 : -1.0;
  const Eigen::Vector2d left(-in.y(), in.x());
  const int steps = std::max(2, static_cast<int>(std::ceil(radius * std::abs(turn) / kStep)));
  for (int i = 1; i <= steps; ++i) {
    const double share = static_cast<double>(i) / steps;
    const double angle = share * std::abs(turn);
    Eigen::Vector3d point;
    point.head<2>() = begin.head<2>() + radius * std::sin(angle) * in +
                      side * radius * (1.0 - std::cos(angle)) * left;
    point.z() = begin.z() + share * (end.z() - begin.z());
    points.push_back(point);
  }
}

/// Points at equal steps along a polyline.
std::vector<Eigen::Vector3d> equally_spaced(const std::vector<Eigen::Vector3d>& points) {
  std::vector<double> distance{0.0};
  for (std::size_t i = 1; i < points.size(); ++i) {
    distance.push_back(distance.back() + (points[i] - points[i - 1]).norm());
  }
  const int steps = std::max(1, static_cast<int>(std::lround(distance.back() / kStep)));
  std::vector<Eigen::Vector3d> result;
  std::size_t next = 1;
  for (int i = 0; i <= steps; ++i) {
    const double at = distance.back() * i / steps;
    while (next + 1 < points.size() && distance[next] < at) ++next;
    const double leg = distance[next] - distance[next - 1];
    const double share = leg > 0.0 ? (at - distance[next - 1]) / leg : 0.0;
    result.emplace_back(points[next - 1] + share * (points[next] - points[next - 1]));
  }
  return result;
}

/// Mean over 2 reach + 1 points; nearer to an end over fewer, so that the ends stay.
std::vector<Eigen::Vector3d> box_filtered(const std::vector<Eigen::Vector3d>& points, int reach) {
  const auto count = static_cast<int>(points.size());
  std::vector<Eigen::Vector3d> sums(points.size() + 1, Eigen::Vector3d::Zero());
  for (std::size_t i = 0; i < points.size(); ++i) sums[i + 1] = sums[i] + points[i];
  std::vector<Eigen::Vector3d> result;
  for (int i = 0; i < count; ++i) {
    const int half = std::min({reach, i, count - 1 - i});
    const auto begin = static_cast<std::size_t>(i - half);
    const std::size_t end = begin + 2 * static_cast<std::size_t>(half) + 1;
    result.emplace_back((sums[end] - sums[begin]) / (2.0 * half + 1.0));
  }
  return result;
}

/// From the change of direction over half a metre.
std::vector<double> curvatures(const std::vector<Eigen::Vector3d>& points) {
  constexpr int kReach = 5;
  const auto count = static_cast<int>(points.size());
  std::vector<double> result(points.size(), 0.0);
  for (int i = kReach; i + kReach < count; ++i) {
    const auto at = [&](int k) -> Eigen::Vector2d {
      return points[static_cast<std::size_t>(k)].head<2>();
    };
    const Eigen::Vector2d in = at(i) - at(i - kReach);
    const Eigen::Vector2d out = at(i + kReach) - at(i);
    const double turn = std::atan2(in.x() * out.y() - in.y() * out.x(), in.dot(out));
    result[static_cast<std::size_t>(i)] =
        std::abs(turn) / std::max(1e-6, 0.5 * (in.norm() + out.norm()));
  }
  return result;
}

}  // namespace

double RoutePath::length_m() const {
  return step_m * static_cast<double>(points_m.size() - 1);
}

Eigen::Vector3d RoutePath::at(double distance_m) const {
  const double place = std::clamp(distance_m, 0.0, length_m()) / step_m;
  const auto index = std::min(static_cast<std::size_t>(place), points_m.size() - 2);
  const double share = place - static_cast<double>(index);
  return points_m[index] + share * (points_m[index + 1] - points_m[index]);
}

double RoutePath::curvature_at(double distance_m) const {
  const double place = std::clamp(distance_m, 0.0, length_m()) / step_m;
  return curvature_per_m[static_cast<std::size_t>(std::lround(place))];
}

RoutePath rounded_path(std::span<const Eigen::Vector3d> waypoints, double corner_radius_m) {
  if (waypoints.size() < 2) throw std::invalid_argument("a route needs two waypoints");
  for (std::size_t i = 1; i < waypoints.size(); ++i) {
    if ((waypoints[i] - waypoints[i - 1]).head<2>().norm() < kStep) {
      throw std::invalid_argument("waypoint " + std::to_string(i + 1) +
                                  " is where the one before is");
    }
  }
  std::vector<Eigen::Vector3d> points{waypoints.front()};
  for (std::size_t i = 1; i + 1 < waypoints.size(); ++i) {
    add_corner(waypoints[i - 1], waypoints[i], waypoints[i + 1], corner_radius_m, points);
  }
  add_straight(waypoints.back(), points);

  constexpr double kSmoothedShare = 0.25;  // of the corner's radius, to either side
  const int reach = std::max(2, static_cast<int>(kSmoothedShare * corner_radius_m / kStep));
  std::vector<Eigen::Vector3d> smooth = equally_spaced(points);
  for (int pass = 0; pass < 3; ++pass) smooth = box_filtered(smooth, reach);
  smooth = equally_spaced(smooth);
  double length = 0.0;
  for (std::size_t i = 1; i < smooth.size(); ++i) length += (smooth[i] - smooth[i - 1]).norm();
  return {.step_m = length / static_cast<double>(smooth.size() - 1),
          .points_m = smooth,
          .curvature_per_m = curvatures(smooth)};
}

}  // namespace fleetloc
