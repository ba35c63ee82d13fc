#include "deploy/sim/recording/sim_motion.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "deploy/sim/motion/vibration.hpp"
#include "deploy/sim/world/route_field.hpp"
#include "shared/geometry/angle.hpp"
#include "shared/trajectory/tum_file.hpp"

namespace fleetloc {
namespace {

RecordFit fitted(const std::filesystem::path& file, const RecordFitConfig& config) {
  const Trajectory poses = read_poses_in_any_order(file);
  try {
    RecordFit fit = fit_record(poses, config);
    if (!fit.within_limits) {
      throw std::invalid_argument(
          "no motion near the record keeps the limits of the configuration");
    }
    return fit;
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(file.string() + ": " + error.what());
  }
}

/// Points a quarter of a metre apart.
std::vector<Eigen::Vector3d> points_along(const SplineMotion& motion) {
  constexpr double kStep = 0.25;  // [m]
  constexpr double kTimeStep = 0.05;
  std::vector<Eigen::Vector3d> path{motion.at(0.0).T_map_body.p};
  const int count = static_cast<int>(motion.duration() / kTimeStep);
  for (int i = 1; i <= count; ++i) {
    const Eigen::Vector3d p = motion.at(kTimeStep * i).T_map_body.p;
    if ((p - path.back()).norm() >= kStep) path.push_back(p);
  }
  return path;
}

/// A motion, and the path along which a world is built: that of the drive forwards.
struct DrivenRoute {
  SplineMotion motion;
  std::vector<Eigen::Vector3d> path_map;
};

DrivenRoute driven_route(const std::filesystem::path& file, const SimConfig& config) {
  const WaypointRoute route = read_route(file);
  WaypointRoute forwards = route;
  forwards.reverse = false;
  try {
    const SplineMotion motion = drive(forwards, config.limits);
    return {.motion = route.reverse ? drive(route, config.limits) : motion,
            .path_map = points_along(motion)};
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(file.string() + ": " + error.what());
  }
}

}  // namespace

SimMotion driven_motion(const SimMotionOptions& options, const SimConfig& config) {
  const Eigen::Vector3d forward = Eigen::Vector3d::UnitX();
  const auto carried = [&config](const SplineMotion& motion) {
    return motion.carried(config.carried.at_s, config.carried.for_s);
  };
  const auto extension = options.file.extension();
  if (extension == ".yaml" || extension == ".yml") {
    const DrivenRoute route = driven_route(options.file, config);
    return {
        .motion = carried(with_vibration(route.motion, config.vibration, forward, options.seed)),
        .start = Timestamp(from_seconds(config.start_s)),
        .path_map = route.path_map};
  }
  RecordFit fit = fitted(options.file, config.record);
  const SplineMotion smooth =
      options.rest_s > 0.0 ? with_rest(fit.motion, options.rest_s, config.speed_up_s) : fit.motion;
  const Timestamp start = fit.start;
  return {.motion = carried(with_vibration(smooth, config.vibration, forward, options.seed)),
          .start = start,
          .path_map = points_along(fit.motion),
          .fit = fit};
}

std::vector<Eigen::Vector3d> path_along(const std::filesystem::path& file,
                                        const SimConfig& config) {
  return driven_motion({.file = file}, config).path_map;
}

void expect_within(std::span<const Eigen::Vector3d> path_map,
                   std::span<const Eigen::Vector3d> streets_m,
                   double clearance_m) {
  constexpr double kBesideRobot = 0.5;  // [m]
  constexpr double kOffGround = 0.5;    // a street's height is that of its nearest point [m]
  const double reach_m = std::max(0.0, clearance_m - kBesideRobot);
  const RouteField streets(streets_m);
  for (const Eigen::Vector3d& p : path_map) {
    const auto around = streets.near(p.head<2>().cast<float>(), static_cast<float>(reach_m));
    const bool within = std::ranges::any_of(around, [&p](const Eigen::Vector3f& street) {
      return std::abs(static_cast<double>(street.z()) - p.z()) <= kOffGround;
    });
    if (within) continue;
    std::ostringstream text;
    text.precision(4);
    text << "leaves the streets at x " << p.x() << ", y " << p.y() << ", z " << p.z()
         << " m: it must stay within " << reach_m << " m beside and " << kOffGround
         << " m above or below them";
    throw std::invalid_argument(text.str());
  }
}

SimMotion replayed_motion(const std::filesystem::path& file, const SimConfig& config) {
  RecordFit fit = fitted(file, config.replayed_record);
  return {.motion = SplineMotion(fit.motion), .start = fit.start, .fit = fit};
}

std::string description(const SimMotion& motion) {
  const MotionMagnitudes most = extremes(motion.motion);
  std::ostringstream text;
  text.precision(4);
  text << "route       " << length_m(motion.motion) << " m in " << motion.motion.duration()
       << " s\ngreatest    " << most.speed << " m/s, " << most.acceleration << " m/s^2, "
       << kDegPerRad * most.turn_rate << " deg/s, " << kDegPerRad * most.angular_acceleration
       << " deg/s^2\n";
  if (!motion.fit) return text.str();
  const auto print = [&text](const char* name, const FitResidual& residual, const char* unit) {
    text << name << "median " << residual.median << ", p95 " << residual.p95 << ", max "
         << residual.max << ' ' << unit << '\n';
  };
  print("residual    ", motion.fit->position_m, "m");
  print("            ", motion.fit->rotation_deg, "deg");
  const MotionMagnitudes& smooth = motion.fit->greatest;
  text << "spline      " << smooth.speed << " m/s, " << smooth.acceleration << " m/s^2, "
       << kDegPerRad * smooth.turn_rate << " deg/s at most; " << motion.fit->outliers
       << " outliers, " << motion.fit->repeated_stamps << " repeated stamps in the record\n";
  return text.str();
}

}  // namespace fleetloc
