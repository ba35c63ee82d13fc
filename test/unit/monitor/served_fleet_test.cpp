#include "deploy/monitor/served_fleet.hpp"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace fleetloc {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

ServedRobot robot_at(double x, const std::string& localizer = "localizer_1") {
  ServedRobot robot{.localizer = localizer,
                    .robot = "robot_1",
                    .quality = Quality::kLocalized,
                    .T_map_body = Pose{.p = {x, 2.0, 3.0}},
                    .up_bytes_per_s = 1400.0};
  robot.covariance.diagonal() << 1e-4, 1e-4, 1e-4, 0.04, 0.01, 0.01;
  return robot;
}

TEST(ServedFleet, IsThereWhileItIsHeardOf) {
  ServedFleet fleet;
  const ArrivalTime begin{1h};
  fleet.add(robot_at(1.0), begin);
  fleet.add(LocalizerStatus{.localizer = "localizer_1", .accepting = true}, begin + 3s);
  fleet.forget_silent(begin + 4s);
  EXPECT_THAT(fleet.robots(), SizeIs(1));
  fleet.forget_silent(begin + 6s);
  EXPECT_THAT(fleet.robots(), IsEmpty());
  EXPECT_THAT(fleet.localizers(), SizeIs(1));
  fleet.add(robot_at(1.0), begin + 7s);
  EXPECT_THAT(fleet.robots(), SizeIs(1)) << "it is back";
}

TEST(ServedFleet, HasNoRobotThatItsLocalizerDoesNotHearAnyMore) {
  ServedFleet fleet;
  ServedRobot robot = robot_at(1.0);
  robot.silent = 20s;
  fleet.add(robot, ArrivalTime{1h});
  fleet.forget_silent(ArrivalTime{1h});
  EXPECT_THAT(fleet.robots(), SizeIs(1)) << "a parked one tells something every ten seconds";
  robot.silent = 31s;
  fleet.add(robot, ArrivalTime{1h});
  fleet.forget_silent(ArrivalTime{1h});
  EXPECT_THAT(fleet.robots(), IsEmpty());
}

TEST(ServedFleet, TakesARobotFromWhoHasHeardOfItLast) {
  ServedFleet fleet;
  ServedRobot old = robot_at(1.0, "localizer_1");
  old.silent = 2s;
  fleet.add(old, ArrivalTime{1h});
  fleet.add(robot_at(5.0, "localizer_2"), ArrivalTime{1h});
  ASSERT_THAT(fleet.robots(), SizeIs(1));
  EXPECT_EQ(fleet.robots()[0].localizer, "localizer_2");
}

TEST(ServedFleet, IsATable) {
  ServedFleet fleet;
  fleet.add(robot_at(1.0), ArrivalTime{1h});
  fleet.add(LocalizerStatus{.localizer = "localizer_1", .sessions = 1, .load = 0.5},
            ArrivalTime{1h});
  const std::string text = table(view_of(fleet));
  EXPECT_THAT(text, HasSubstr("robot_1  -     localized  -      0.200 m  1.4 KB/s"));
  EXPECT_THAT(text, HasSubstr("localizer_1  full   1       50 %"));
  ServedRobot searching{.localizer = "localizer_1",
                        .robot = "robot_2",
                        .quality = Quality::kSearching,
                        .possible_places = {{1.0, 2.0, 3.0}, {4.0, 5.0, 6.0}}};
  fleet.add(searching, ArrivalTime{1h});
  EXPECT_THAT(table(view_of(fleet)), HasSubstr("searching, 2 places"));
}

TEST(ServedFleet, IsJsonForThePage) {
  ServedFleet fleet;
  fleet.add(robot_at(1.0), ArrivalTime{1h});
  ServedRobot lost{.localizer = "localizer_1", .robot = "robot_2", .quality = Quality::kLost};
  lost.possible_places = {{1.0, 2.0, 3.0}, {4.0, 5.0, 6.0}};
  fleet.add(lost, ArrivalTime{1h});
  fleet.add(LocalizerStatus{.localizer = "localizer_1", .sessions = 2, .load = 0.25},
            ArrivalTime{1h});
  const auto json = nlohmann::json::parse(json_of(fleet));
  const auto& robot = json.at("robots").at(0);
  EXPECT_EQ(robot.at("name"), "robot_1");
  EXPECT_EQ(robot.at("state"), "localized");
  EXPECT_EQ(robot.at("position"), nlohmann::json({1.0, 2.0, 3.0}));
  EXPECT_NEAR(robot.at("ellipse").at(0).get<double>(), 0.2, 1e-9);
  EXPECT_NEAR(robot.at("ellipse").at(1).get<double>(), 0.1, 1e-9);
  EXPECT_NEAR(std::sin(robot.at("ellipse").at(2).get<double>()), 0.0, 1e-9);
  EXPECT_EQ(robot.at("up_bytes_per_s"), 1400);
  EXPECT_TRUE(json.at("robots").at(1).at("position").is_null());
  EXPECT_EQ(json.at("robots").at(1).at("possible_places").at(1), nlohmann::json({4.0, 5.0, 6.0}));
  EXPECT_EQ(json.at("localizers").at(0).at("load"), 0.25);
}

}  // namespace
}  // namespace fleetloc
