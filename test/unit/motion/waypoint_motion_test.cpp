#include "deploy/sim/motion/waypoint_motion.hpp"

#include <cmath>
#include <stdexcept>

#include <gmock/gmock.h>

#include "deploy/sim/motion/route_path.hpp"

namespace fleetloc {
namespace {

const MotionMagnitudes kRouteLimits{
    .speed = 2.0, .acceleration = 1.0, .turn_rate = 0.8, .angular_acceleration = 3.0};

WaypointRoute block() {
  WaypointRoute route;
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, {30.0, 0.0}, {30.0, 20.0}, {0.0, 25.0}}) {
    route.waypoints_m.emplace_back(x, y, 0.0);
  }
  route.loop = true;
  route.laps = 2;
  return route;
}

TEST(WaypointMotion, KeepsTheLimitsAndGoesTheWay) {
  const WaypointRoute route = block();
  const SplineMotion motion = drive(route, kRouteLimits);
  const MotionMagnitudes most = extremes(motion);
  EXPECT_NEAR(most.speed, route.speed, 0.02);
  EXPECT_LT(most.acceleration, kRouteLimits.acceleration);
  EXPECT_GT(most.acceleration, 0.2 * kRouteLimits.acceleration);
  EXPECT_LT(most.turn_rate, kRouteLimits.turn_rate);
  EXPECT_LT(most.angular_acceleration, kRouteLimits.angular_acceleration);
  const double around = 30.0 + 20.0 + std::hypot(30.0, 5.0) + 25.0;
  EXPECT_NEAR(length_m(motion), 2.0 * around, 0.06 * 2.0 * around);  // corners are cut
}

TEST(WaypointMotion, RestsAtTheStartAndEndsAtRest) {
  const SplineMotion motion = drive(block(), kRouteLimits);
  for (const double time_s : {0.0, 1.0, 1.8, motion.duration()}) {
    const MotionState state = motion.at(time_s);
    EXPECT_LT(state.v_map.norm(), 2e-3) << time_s;
    EXPECT_LT(state.a_map.norm(), 2e-2) << time_s;
    EXPECT_LT(state.angular_velocity.norm(), 1e-3) << time_s;
    EXPECT_LT((state.T_map_body.p - Eigen::Vector3d(0.0, 0.0, 0.0)).norm(), 1e-3) << time_s;
  }
}

TEST(WaypointMotion, LooksAlongItsWayAndFollowsTheSlope) {
  const auto slope = [](double x, double y) { return 0.1 * x - 0.03 * y; };
  WaypointRoute route = block();
  for (Eigen::Vector3d& p : route.waypoints_m) p.z() = slope(p.x(), p.y());
  const SplineMotion motion = drive(route, kRouteLimits);
  for (int i = 0; 6.0 + 0.7 * i < motion.duration() - 4.0; ++i) {
    const double time_s = 6.0 + 0.7 * i;
    const MotionState state = motion.at(time_s);
    const Eigen::Vector3d forward = state.T_map_body.R * Eigen::Vector3d::UnitX();
    EXPECT_GT(forward.dot(state.v_map.normalized()), 0.995) << time_s;
    const Eigen::Vector3d& p = state.T_map_body.p;
    EXPECT_NEAR(p.z(), slope(p.x(), p.y()), 0.1) << time_s;
    const Eigen::Vector3d left = state.T_map_body.R * Eigen::Vector3d::UnitY();
    EXPECT_NEAR(left.z(), 0.0, 0.01) << time_s;  // no roll
  }
}

TEST(WaypointMotion, SurvivesATurnOnTheSpot) {
  WaypointRoute route;
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, {10.0, 0.0}, {0.0, 0.0}}) {
    route.waypoints_m.emplace_back(x, y, 0.0);
  }
  const MotionMagnitudes most = extremes(drive(route, kRouteLimits));
  EXPECT_TRUE(std::isfinite(most.angular_acceleration));
  EXPECT_LT(most.speed, 1.3);
}

TEST(RoutePath, RoundsCornersWithTheRadiusAskedFor) {
  const std::vector<Eigen::Vector3d> corner{{0, 0, 0}, {20, 0, 0}, {20, 20, 0}};
  const RoutePath path = rounded_path(corner, 4.0);
  EXPECT_NEAR(path.length_m(), 40.0 - 2.0 * 4.0 + 0.5 * 4.0 * M_PI, 0.3);
  double greatest = 0.0;
  double turned = 0.0;
  for (const double curvature : path.curvature_per_m) {
    greatest = std::max(greatest, curvature);
    turned += curvature * path.step_m;
  }
  EXPECT_NEAR(greatest, 1.0 / 4.0, 0.05);
  EXPECT_NEAR(turned, 0.5 * M_PI, 0.02);
}

TEST(RoutePath, RefusesWhatIsNoWay) {
  const std::vector<Eigen::Vector3d> one{{0, 0, 0}};
  const std::vector<Eigen::Vector3d> same{{0, 0, 0}, {1, 1, 0}, {1, 1, 2}};
  EXPECT_THROW(static_cast<void>(rounded_path(one, 1.0)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(rounded_path(same, 1.0)), std::invalid_argument);
}

}  // namespace
}  // namespace fleetloc
