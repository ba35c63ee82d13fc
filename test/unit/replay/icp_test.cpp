#include "deploy/replay/icp.hpp"

#include <gmock/gmock.h>

#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

constexpr IcpConfig kConfig{.max_distance_m = 1.0, .iterations = 100, .settled_m = 1e-5};

/// The floor and two walls of a room, a point every 0.1 m, with a corner 300 m from the origin.
std::vector<Eigen::Vector3f> room() {
  std::vector<Eigen::Vector3f> points;
  const Eigen::Vector3f corner(300.0F, -200.0F, 5.0F);
  for (int i = 0; i < 50; ++i) {
    for (int k = 0; k < 50; ++k) {
      const float a = 0.1F * static_cast<float>(i);
      const float b = 0.1F * static_cast<float>(k);
      points.emplace_back(corner + Eigen::Vector3f(a, b, 0.0F));
      points.emplace_back(corner + Eigen::Vector3f(a, 0.0F, b));
      points.emplace_back(corner + Eigen::Vector3f(0.0F, a, b));
    }
  }
  return points;
}

/// Some of the room's points, in a frame of their own.
std::vector<Eigen::Vector3d> seen_from(const Pose& T_room_robot) {
  std::vector<Eigen::Vector3d> seen;
  const auto points = room();
  for (std::size_t i = 0; i < points.size(); i += 17) {
    seen.push_back(inverse(T_room_robot) * points[i].cast<double>());
  }
  return seen;
}

Pose robot() {
  return {.R = exp_so3(Eigen::Vector3d(0.02, -0.01, 0.8)), .p = Eigen::Vector3d(302, -198, 6)};
}

TEST(Icp, FindsWhereTheSourceLies) {
  const IcpTarget target(room());
  const Pose start = robot() * Pose{.R = exp_so3(Eigen::Vector3d(0.0, 0.003, 0.005)),
                                    .p = Eigen::Vector3d(0.03, -0.03, 0.02)};
  const IcpResult result = target.align(seen_from(robot()), start, kConfig);
  EXPECT_TRUE(result.converged);
  EXPECT_LT(local_coordinates(robot(), result.T_target_source).norm(), 0.005);
  EXPECT_EQ(result.matched_share, 1.0);
  EXPECT_LT(result.rms_m, 0.005);
}

TEST(Icp, TellsWhatLiesOffTheTarget) {
  auto source = seen_from(robot());
  const std::size_t all = source.size();
  for (std::size_t i = 0; i < all; ++i) source.emplace_back(0.0, 0.0, 20.0);
  const IcpResult result = IcpTarget(room()).align(source, robot(), kConfig);
  EXPECT_EQ(result.matched_share, 0.5);
  EXPECT_LT(local_coordinates(robot(), result.T_target_source).norm(), 0.01);
}

TEST(Icp, DoesNotConvergeWhereNothingIsNear) {
  Pose start = robot();
  start.p.z() += 50.0;
  const IcpResult result = IcpTarget(room()).align(seen_from(robot()), start, kConfig);
  EXPECT_FALSE(result.converged);
  EXPECT_EQ(result.T_target_source.p, start.p);
  EXPECT_FALSE(IcpTarget(room()).align({}, robot(), kConfig).converged);
}

}  // namespace
}  // namespace fleetloc
