#include "deploy/sim/room/room_trajectory.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "deploy/sim/room/room.hpp"
#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

void expect_derivatives(const RoomTrajectory& trajectory, double time_s) {
  constexpr double kStep = 1e-5;
  const Motion before = trajectory.at(time_s - kStep);
  const Motion here = trajectory.at(time_s);
  const Motion after = trajectory.at(time_s + kStep);
  const Eigen::Vector3d velocity = (after.T_room_body.p - before.T_room_body.p) / (2.0 * kStep);
  const Eigen::Vector3d acceleration = (after.v_room - before.v_room) / (2.0 * kStep);
  const Eigen::Vector3d rate =
      log_so3(before.T_room_body.R.conjugate() * after.T_room_body.R) / (2.0 * kStep);
  EXPECT_LT((velocity - here.v_room).norm(), 1e-7) << time_s;
  EXPECT_LT((acceleration - here.a_room).norm(), 1e-7) << time_s;
  EXPECT_LT((rate - here.angular_velocity).norm(), 1e-7) << time_s;
}

TEST(RoomTrajectory, DerivativesMatchDifferences) {
  for (const double rest_s : {0.0, 1.0}) {
    const RoomTrajectory trajectory(rest_s, 1.3);
    for (int i = 0; i < 60; ++i) {
      expect_derivatives(trajectory, 0.5 + 0.33 * i);
    }
  }
}

TEST(RoomTrajectory, StopsOnItsWayAndGoesOn) {
  const RoomTrajectory trajectory(1.0, 1.3, {.at_s = 8.0, .stands_s = 5.0});
  for (int i = 0; i < 60; ++i) expect_derivatives(trajectory, 0.5 + 0.33 * i);
  const Motion stopped = trajectory.at(10.0);
  EXPECT_EQ(stopped.v_room.norm(), 0.0);
  EXPECT_EQ(trajectory.at(15.0).T_room_body.p, stopped.T_room_body.p);
  EXPECT_GT(trajectory.at(17.0).v_room.norm(), 0.3);
  const RoomTrajectory without(1.0, 1.3);  // slowing down and speeding up take a second more each
  EXPECT_LT((trajectory.at(27.0).T_room_body.p - without.at(20.0).T_room_body.p).norm(), 1e-9);
}

TEST(RoomTrajectory, StandsStillWhileItRests) {
  const RoomTrajectory trajectory(2.0, 1.0);
  const Motion at_start = trajectory.at(0.0);
  const Motion at_end = trajectory.at(2.0);
  EXPECT_EQ(at_start.T_room_body.p, at_end.T_room_body.p);
  EXPECT_EQ(at_end.v_room.norm(), 0.0);
  EXPECT_EQ(at_end.a_room.norm(), 0.0);
  EXPECT_EQ(at_end.angular_velocity.norm(), 0.0);
  EXPECT_LT(trajectory.at(2.01).a_room.norm(), 1e-2);
}

TEST(RoomTrajectory, HasTheSpeedAskedForAndKeepsClearOfEverything) {
  const Room room;
  const RoomTrajectory trajectory(0.0, 1.5);
  double square = 0.0;
  constexpr int kInstants = 4000;
  for (int i = 0; i < kInstants; ++i) {
    const Motion motion = trajectory.at(0.01 * i);
    square += motion.v_room.squaredNorm() / kInstants;
    const Eigen::Vector3d& p = motion.T_room_body.p;
    EXPECT_LT(std::abs(p.x()), 4.2);
    EXPECT_LT(std::abs(p.y()), 3.2);
    for (const Room::Box& box : room.furniture()) {
      const Eigen::Vector3d p_box = inverse(box.T_room_box) * p;
      const Eigen::Vector3d outside = (p_box.cwiseAbs() - box.half_size).cwiseMax(0.0);
      EXPECT_GT(outside.norm(), 0.25) << p.transpose();
    }
  }
  EXPECT_NEAR(std::sqrt(square), 1.5, 0.1);
}

}  // namespace
}  // namespace fleetloc
