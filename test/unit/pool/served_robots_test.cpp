#include "cloud/pool/served_robots.hpp"

#include <gtest/gtest.h>

#include "test/unit/timestamps.hpp"

namespace fleetloc {
namespace {

TEST(ServedRobots, HaveThePoseOfTheirNewestAnswer) {
  ServedRobots robots("localizer_1");
  robots.open("robot_1", SessionNumber{3}, at(1.0));
  EXPECT_FALSE(robots.all(at(1.0)).at(0).T_map_body);
  LocalizationResult answer;
  answer.status = LocalizationStatus::kLocalized;
  answer.T_map_body.p = {1.0, 2.0, 3.0};
  robots.answered("robot_1", answer);
  answer.status = LocalizationStatus::kTooFewMatches;
  answer.T_map_body.p = {9.0, 9.0, 9.0};
  robots.answered("robot_1", answer);
  robots.told({.robot = "robot_1",
               .session = SessionNumber{3},
               .start_stamp = {},
               .stamp = {},
               .quality = Quality::kLocalized,
               .round_trip = std::chrono::seconds(1)});
  const ServedRobot robot = robots.all(at(1.5)).at(0);
  EXPECT_EQ(robot.localizer, "localizer_1");
  EXPECT_EQ(robot.session, SessionNumber{3});
  EXPECT_EQ(robot.quality, Quality::kLocalized);
  EXPECT_EQ(robot.T_map_body->p, Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(robot.silent, Duration(std::chrono::milliseconds(500)));
  robots.open("robot_1", SessionNumber{4}, at(2.0));
  EXPECT_FALSE(robots.all(at(2.0)).at(0).T_map_body) << "of the session before";
  robots.erase("robot_1");
  EXPECT_TRUE(robots.all(at(2.0)).empty());
}

TEST(ServedRobots, MayBeAtSeveralPlaces) {
  ServedRobots robots("localizer_1");
  robots.open("robot_1", SessionNumber{3}, at(1.0));
  robots.searched("robot_1", std::vector(20, Eigen::Vector3d(1.0, 2.0, 3.0)));
  EXPECT_EQ(robots.all(at(1.0)).at(0).possible_places.size(), kMaxPossiblePlaces);
  robots.searched("robot_1", {});
  EXPECT_TRUE(robots.all(at(1.0)).at(0).possible_places.empty());
  robots.searched("robot_2", {Eigen::Vector3d::Zero()});
  EXPECT_EQ(robots.all(at(1.0)).size(), 1U) << "it has no session";
}

TEST(ServedRobots, HaveTheTrafficOfTheLatestSecondsOnTheWire) {
  ServedRobots robots("localizer_1");
  robots.open("robot_1", SessionNumber{3}, at(0.0));
  for (int i = 0; i <= 400; ++i) {  // 40 s
    robots.received("robot_1", 1000, at(0.1 * i));
    robots.sent("robot_1", 100, at(0.1 * i));
  }
  const ServedRobot robot = robots.all(at(40.0)).at(0);
  EXPECT_NEAR(robot.up_bytes_per_s, 10 * 1100.0, 300.0);
  EXPECT_NEAR(robot.down_bytes_per_s, 10 * 200.0, 60.0);
  EXPECT_LT(robots.all(at(70.0)).at(0).up_bytes_per_s, 50.0);
}

TEST(ServedRobots, AreNotThoseWithoutASession) {
  ServedRobots robots("localizer_1");
  robots.received("robot_1", 1000, at(0.0));
  robots.sent("robot_1", 1000, at(0.0));
  robots.answered("robot_1", {});
  EXPECT_TRUE(robots.all(at(0.0)).empty());
}

}  // namespace
}  // namespace fleetloc
