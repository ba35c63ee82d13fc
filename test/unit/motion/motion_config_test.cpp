#include "deploy/sim/motion/motion_config.hpp"

#include <algorithm>

#include <gmock/gmock.h>

namespace fleetloc {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr const char* kRest =
    "speed_m_s: 1.2\nrest_s: 2\ncorner_radius_m: 3\nloop: false\nlaps: 1\n";

std::string with_laps_of_a_loop(const std::string& waypoints) {
  return "speed_m_s: 1.2\nrest_s: 2\ncorner_radius_m: 3\nloop: true\nlaps: 2\n" + waypoints;
}

WaypointRoute read(const std::string& text) {
  return read_route(ConfigReader::from_string(text, "route.yaml"));
}

void expect_refused(const std::string& text, const std::string& culprit) {
  EXPECT_THAT([&] { static_cast<void>(read(text)); },
              ThrowsMessage<ConfigError>(HasSubstr(culprit)));
}

TEST(RouteFile, HoldsWaypointsWithOrWithoutHeight) {
  const WaypointRoute route = read(std::string(kRest) + "waypoints: [[0, 1], [2, 3, 0.5]]\n");
  ASSERT_EQ(route.waypoints_m.size(), 2U);
  EXPECT_EQ(route.waypoints_m[0], Eigen::Vector3d(0.0, 1.0, 0.0));
  EXPECT_EQ(route.waypoints_m[1], Eigen::Vector3d(2.0, 3.0, 0.5));
  EXPECT_EQ(route.speed, 1.2);
}

TEST(RouteFile, MayBeDrivenInTheOppositeDirection) {
  const std::string text = with_laps_of_a_loop("waypoints: [[0, 1], [2, 3], [4, 0]]\n");
  const auto forwards = driven_waypoints(read(text));
  auto backwards = driven_waypoints(read(text + "reverse: true\n"));
  EXPECT_NE(forwards, backwards);
  std::ranges::reverse(backwards);
  EXPECT_EQ(forwards, backwards);
}

TEST(RouteFile, IsRefusedWithTheNameOfWhatIsWrong) {
  const std::string rest = kRest;
  expect_refused(rest, "waypoints: missing");
  expect_refused(rest + "waypoints: [[0, 1]]\n", "two at least");
  expect_refused(rest + "waypoints: [[0, 1], [2]]\n", "the 2. one");
  expect_refused(rest + "waypoints: [[0, 1], [2, .nan]]\n", "not finite");
  expect_refused(rest + "waypoints: [[0, 1], [2, 3]]\nspead: 3\n", "spead: unknown key");
  expect_refused("speed_m_s: -1\nwaypoints: [[0, 1], [2, 3]]\n", "route.yaml:1: speed_m_s");
}

}  // namespace
}  // namespace fleetloc
