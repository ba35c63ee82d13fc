#include "deploy/monitor/fleet_view.hpp"

#include <gmock/gmock.h>

namespace fleetloc {
namespace {

FleetView fleet() {
  RobotView driving{.name = "robot_1",
                    .time_s = 34.25,
                    .state = "localized",
                    .error_m = 0.0214,
                    .sigma_m = 0.03,
                    .uplink_kb_s = 18.0,
                    .downlink_kb_s = 3.1,
                    .round_trip_s = 0.5};
  RobotView waiting;
  waiting.name = "robot_2";
  RobotView ended = driving;
  ended.name = "r";
  ended.ended = true;
  return {.robots = {driving, waiting, ended},
          .localizers = {{.name = "localizer_1",
                          .state = "draining",
                          .sessions = "2",
                          .load = 0.123,
                          .submaps = "40",
                          .localized = "38"}}};
}

TEST(FleetView, IsATableWithALineForEach) {
  EXPECT_EQ(table(fleet()),
            "robot    time    state      error    1 sigma  up         down      round trip\n"
            "robot_1  34.2 s  localized  0.021 m  0.030 m  18.0 KB/s  3.1 KB/s  0.50 s\n"
            "robot_2  -       -          -        -        -          -         -\n"
            "r        34.2 s  ended      0.021 m  0.030 m  18.0 KB/s  3.1 KB/s  0.50 s\n"
            "localizer    state     robots  load  submaps  localized\n"
            "localizer_1  draining  2       12 %  40       38\n");
}

TEST(FleetView, IsOneLineInAPipe) {
  FleetView view = fleet();
  view.robots.resize(1);
  EXPECT_EQ(line(view),
            "robot_1 34.2 s localized, error 0.021 m, sigma 0.030 m, up 18.0 KB/s, down 3.1 KB/s, "
            "round trip 0.50 s; localizer_1: draining, robots 2, load 12 %, localized 38");
}

}  // namespace
}  // namespace fleetloc
