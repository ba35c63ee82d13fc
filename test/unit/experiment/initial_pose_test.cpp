#include "deploy/evaluation/experiment/initial_pose.hpp"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "test/unit/experiment/plan_files.hpp"

namespace fleetloc {
namespace {

TEST(MapOdomEstimate, LiesAsFarFromTheTruthAsThePlanSays) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const auto [x, y, z, yaw] = start_displacement({.position_m = 0.3, .yaw_deg = 3.0}, seed);
    EXPECT_NEAR(std::hypot(x, y, z), 0.3, 1e-12);
    EXPECT_EQ(std::abs(yaw), 3.0);
  }
}

TEST(MapOdomEstimate, IsDrawnByTheSeedAlone) {
  const StartError error;
  EXPECT_EQ(start_displacement(error, 1), start_displacement(error, 1));
  EXPECT_NE(start_displacement(error, 1), start_displacement(error, 2));
}

TEST(MapOdomEstimate, IsThatOfTheFirstFrameThatIsPlayed) {
  write("index.csv", "#timestamp\n1000000000,a\n1500000000,b\n2600000000,c\n");
  const auto index = test_folder() / "index.csv";
  EXPECT_EQ(first_frame(index, 0.0).time_since_epoch().count(), 1'000'000'000);
  EXPECT_EQ(first_frame(index, 1.0).time_since_epoch().count(), 2'600'000'000);
  EXPECT_THROW(static_cast<void>(first_frame(index, 2.0)), std::runtime_error);
}

}  // namespace
}  // namespace fleetloc
