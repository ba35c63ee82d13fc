#include "deploy/sim/motion/waypoint_motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "deploy/sim/motion/route_path.hpp"

namespace fleetloc {
namespace {

constexpr double kTimeStep = 0.02;      // of the speed over time [s]
constexpr double kKnotInterval = 0.05;  // [s]
constexpr double kShareOfLimit = 0.6;
constexpr double kJerkTime = 1.0;   // over which an acceleration builds up and goes [s]
constexpr double kRestAtEnd = 0.5;  // [s]

/// The greatest speed at each point of the path: by the route, by curvature, and reachable from
/// and down to standstill at both ends.
std::vector<double> speeds_along(const RoutePath& path,
                                 double speed,
                                 const MotionMagnitudes& limits) {
  constexpr double kMin = 0.05;  // keeps time finite [m/s]
  const double acceleration = kShareOfLimit * limits.acceleration;
  std::vector<double> speeds;
  for (const double curvature : path.curvature_per_m) {
    const double bend = std::max(curvature, 1e-6);
    speeds.push_back(
        std::min({speed, kShareOfLimit * limits.turn_rate / bend, std::sqrt(acceleration / bend)}));
  }
  const double gain = 2.0 * acceleration * path.step_m;
  speeds.front() = speeds.back() = kMin;
  for (std::size_t i = 1; i < speeds.size(); ++i) {
    speeds[i] = std::min(speeds[i], std::sqrt(speeds[i - 1] * speeds[i - 1] + gain));
  }
  for (std::size_t i = speeds.size() - 1; i > 0; --i) {
    speeds[i - 1] = std::min(speeds[i - 1], std::sqrt(speeds[i] * speeds[i] + gain));
  }
  return speeds;
}

/// Distance gone at each time step, from rest to rest.
std::vector<double> distances_over_time(const RoutePath& path, const std::vector<double>& speeds) {
  std::vector<double> distances{0.0};
  double time_s = 0.0;
  for (std::size_t i = 1; i < path.points_m.size(); ++i) {
    const double step_s = path.step_m / (0.5 * (speeds[i - 1] + speeds[i]));
    const double start_s = time_s;
    time_s += step_s;
    while (static_cast<double>(distances.size()) * kTimeStep <= time_s) {
      const double share = (static_cast<double>(distances.size()) * kTimeStep - start_s) / step_s;
      distances.push_back(path.step_m * (static_cast<double>(i - 1) + share));
    }
  }
  distances.push_back(path.length_m());
  return distances;
}

/// Three times the mean over half of `kJerkTime`, standing still before and after: acceleration
/// becomes continuous, and distances still increase from zero to the whole.
std::vector<double> jerk_limited(std::vector<double> distances) {
  const auto reach = static_cast<std::ptrdiff_t>(kJerkTime / (4.0 * kTimeStep));
  constexpr int kPasses = 3;
  distances.insert(distances.begin(), static_cast<std::size_t>(kPasses * reach), 0.0);
  distances.insert(distances.end(), static_cast<std::size_t>(kPasses * reach), distances.back());
  const auto count = static_cast<std::ptrdiff_t>(distances.size());
  for (int pass = 0; pass < kPasses; ++pass) {
    std::vector<double> sums{0.0};
    for (const double distance : distances) sums.push_back(sums.back() + distance);
    for (std::ptrdiff_t i = 0; i < count; ++i) {
      const std::ptrdiff_t begin = std::max<std::ptrdiff_t>(0, i - reach);
      const std::ptrdiff_t end = std::min(count, i + reach + 1);
      distances[static_cast<std::size_t>(i)] =
          (sums[static_cast<std::size_t>(end)] - sums[static_cast<std::size_t>(begin)]) /
          static_cast<double>(end - begin);
    }
  }
  return distances;
}

double interpolated(const std::vector<double>& values, double place) {
  const double inside = std::clamp(place, 0.0, static_cast<double>(values.size() - 1));
  const auto index = std::min(static_cast<std::size_t>(inside), values.size() - 2);
  const double share = inside - static_cast<double>(index);
  return values[index] + share * (values[index + 1] - values[index]);
}

/// The body on the path, facing along it.
Pose pose_on(const RoutePath& path, double distance_m) {
  constexpr double kAhead = 0.25;  // [m]
  const double begin = std::clamp(distance_m - kAhead, 0.0, path.length_m() - 2.0 * kAhead);
  const Eigen::Vector3d along = path.at(begin + 2.0 * kAhead) - path.at(begin);
  const double yaw = std::atan2(along.y(), along.x());
  const double pitch = -std::atan2(along.z(), along.head<2>().norm());
  return {.R = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
               Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()),
          .p = path.at(distance_m)};
}

}  // namespace

std::vector<Eigen::Vector3d> driven_waypoints(const WaypointRoute& route) {
  std::vector<Eigen::Vector3d> waypoints;
  for (int lap = 0; lap < (route.loop ? route.laps : 1); ++lap) {
    waypoints.insert(waypoints.end(), route.waypoints_m.begin(), route.waypoints_m.end());
  }
  if (route.loop && !waypoints.empty()) waypoints.emplace_back(waypoints.front());
  if (route.reverse) std::ranges::reverse(waypoints);
  return waypoints;
}

SplineMotion drive(const WaypointRoute& route, const MotionMagnitudes& limits) {
  const RoutePath path = rounded_path(driven_waypoints(route), route.corner_radius_m);
  const auto distances =
      jerk_limited(distances_over_time(path, speeds_along(path, route.speed, limits)));
  const double moving_s = kTimeStep * static_cast<double>(distances.size() - 1);
  const SplineGrid grid = grid_over(route.rest_s + moving_s + kRestAtEnd, kKnotInterval);
  return spline_through(grid, [&](double time_s) {
    return pose_on(path, interpolated(distances, (time_s - route.rest_s) / kTimeStep));
  });
}

}  // namespace fleetloc
